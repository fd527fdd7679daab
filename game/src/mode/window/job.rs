//! Work beside the window: a thread that tells how far it is, so that the window answers from the first second.

use std::sync::mpsc::{Receiver, TryRecvError, channel};

enum News<T> {
    At(f32, String),
    Done(T),
}

/// A piece of work in progress.
pub struct Job<T> {
    news: Receiver<News<T>>,
    /// 0 … 1.
    pub fraction: f32,
    /// What is being done.
    pub what: String,
}

/// How a job stands.
pub enum Outcome<T> {
    /// Still at it.
    Running,
    /// Done.
    Done(T),
    /// Its thread is gone without a result.
    Died,
}

impl<T: Send + 'static> Job<T> {
    /// Starts work on a thread of its own; it is given a function to tell its progress with.
    pub fn spawn(work: impl FnOnce(&(dyn Fn(f32, &str) + Sync)) -> T + Send + 'static) -> Self {
        let (tell, news) = channel();
        std::thread::spawn(move || {
            let progress = std::sync::Mutex::new(tell.clone());
            let done = work(&|fraction, what| {
                if let Ok(tell) = progress.lock() {
                    // Nobody listens any more when the window was closed: the work then ends unheard.
                    let _ = tell.send(News::At(fraction, what.to_owned()));
                }
            });
            let _ = tell.send(News::Done(done));
        });
        Self { news, fraction: 0.0, what: String::new() }
    }

    /// Hears what is new.
    pub fn poll(&mut self) -> Outcome<T> {
        loop {
            match self.news.try_recv() {
                Ok(News::At(fraction, what)) => (self.fraction, self.what) = (fraction.clamp(0.0, 1.0), what),
                Ok(News::Done(done)) => return Outcome::Done(done),
                Err(TryRecvError::Empty) => return Outcome::Running,
                Err(TryRecvError::Disconnected) => return Outcome::Died,
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn progress_comes_before_the_result_and_a_dead_thread_is_noticed() {
        let mut job = Job::spawn(|progress| {
            progress(0.5, "half");
            7
        });
        let done = loop {
            match job.poll() {
                Outcome::Running => std::thread::yield_now(),
                Outcome::Done(x) => break x,
                Outcome::Died => panic!("it did not die"),
            }
        };
        assert_eq!((done, job.fraction, job.what.as_str()), (7, 0.5, "half"));
        // The thread may take a moment to end after it has told its result.
        let after = loop {
            match job.poll() {
                Outcome::Running => std::thread::yield_now(),
                other => break other,
            }
        };
        assert!(matches!(after, Outcome::Died));
    }
}
