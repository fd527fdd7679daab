//! A draft of an air: the values of one body's `atmosphere.toml` while somebody turns them, with undo, and the file that they go into.
//!
//! A draft changes nothing but itself until it is saved: whoever draws it draws a copy of the World that never ticks, so that what one sees
//! while editing is no part of a flight. What is saved comes back through the hot reload like any edited file, drag included.
//!
//! Which file: that of the mod on top, never the game's own assets unless that is asked for ([`Target`]). Where the mod has an
//! `atmosphere.toml` of its own that is written, else an `atmosphere.patch.toml` with only what differs. Not here: the panel
//! ([`crate::hud::air`]), how a file is written ([`super::write`]).

use super::atmosphere::{AirSpec, Datum, Setting, read_air};
use super::fault::{AssetErrors, Fault, Source};
use super::overlay::{Overlay, read_text};
use super::reader::{Faults, Reader};
use super::tree::{Node, parse};
use super::write;
use engine::light::spectrum::Starlight;
use serde_json::{Map, Value, json};
use std::path::{Path, PathBuf};
use std::sync::Arc;

mod begin;

pub use begin::{LAYERS, Place, bank, fill, first, first_air, layer, ways};

/// Steps that can be undone.
const STEPS: usize = 200;
/// What stands at the head of a new file.
const HEAD: &str = "# Written by the editor of airs in the game. Edit it by hand as well: comments stay.\n";

/// Where a draft may be written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Target {
    /// Into the mod on top.
    #[default]
    Mod,
    /// Into the game's own assets.
    Assets,
}

/// The draft of one body's air.
#[derive(Clone, Debug)]
pub struct Draft {
    /// The body's key.
    pub body: String,
    /// The values as they are now.
    pub now: Value,
    /// The file that they go into.
    pub path: PathBuf,
    /// What lies under that file; nothing where the file holds all.
    base: Option<Value>,
    saved: Value,
    undone: Vec<Value>,
    done: Vec<Value>,
    /// The last step goes on: a slider is held.
    held: bool,
}

impl Draft {
    /// The draft of a body's air as its files have it now; of a body without air an empty one.
    ///
    /// # Errors
    /// What is wrong with the files.
    pub fn open(overlay: &Overlay, body: &str, target: Target) -> Result<Self, AssetErrors> {
        let relative = format!("bodies/{body}/atmosphere.toml");
        let patch = format!("bodies/{body}/atmosphere.patch.toml");
        let roots = overlay.roots();
        let nowhere =
            || AssetErrors::one(Fault::file(&overlay.expected(&relative), "no mod is laid over the assets that it could be written into"));
        let root = match target {
            Target::Assets => roots.first(),
            Target::Mod => roots.get(1..).and_then(<[PathBuf]>::last),
        };
        let root = root.ok_or_else(nowhere)?;
        let whole = root.join(&relative);
        // What lies in the other files: all of them, but for a file of the game's own, over which mods may lie.
        let under: Vec<PathBuf> = overlay.with_patches(&relative).into_iter().filter(|p| *p != root.join(&patch)).collect();
        let (path, base) = if target == Target::Assets || whole.is_file() || under.is_empty() {
            (whole, None)
        } else {
            (root.join(&patch), Some(read(&under)?))
        };
        let now = match &base {
            None if path.is_file() => read(std::slice::from_ref(&path))?,
            None => json!({}),
            Some(_) => read(&under.into_iter().chain(Some(path.clone()).filter(|p| p.is_file())).collect::<Vec<_>>())?,
        };
        Ok(Self { body: body.to_owned(), saved: now.clone(), now, path, base, undone: Vec::new(), done: Vec::new(), held: false })
    }

    /// Takes over what the files say since somebody wrote them elsewhere: a draft that was saved follows, as a step; one that was not stays,
    /// and would go back to what they say now.
    pub fn follow(&mut self, overlay: &Overlay, target: Target) {
        let Ok(Self { now, path, base, .. }) = Self::open(overlay, &self.body, target) else { return };
        (self.path, self.base) = (path, base);
        // Written 3.0 and read as 3, what was saved from here is no news.
        if write::same(&now, &self.saved) {
            return;
        }
        let was_saved = self.is_saved();
        self.saved = now;
        if was_saved {
            self.revert();
        }
    }

    /// Takes a step. While a slider is `held` its many values are one step.
    pub fn step(&mut self, now: Value, held: bool) {
        if now == self.now {
            self.held &= held;
            return;
        }
        let before = std::mem::replace(&mut self.now, now);
        if !self.held {
            self.done.push(before);
            if self.done.len() > STEPS {
                self.done.remove(0);
            }
        }
        self.undone.clear();
        self.held = held;
    }

    /// One step back; false where there is none.
    pub fn undo(&mut self) -> bool {
        let Some(before) = self.done.pop() else { return false };
        self.undone.push(std::mem::replace(&mut self.now, before));
        self.held = false;
        true
    }

    /// One step forward again.
    pub fn redo(&mut self) -> bool {
        let Some(after) = self.undone.pop() else { return false };
        self.done.push(std::mem::replace(&mut self.now, after));
        self.held = false;
        true
    }

    /// Back to the file, as a step.
    pub fn revert(&mut self) {
        self.step(self.saved.clone(), false);
    }

    /// Back to what lies under the file, as a step; saved, the file goes.
    pub fn reset(&mut self) {
        if let Some(base) = self.base.clone() {
            self.step(base, false);
        }
    }

    /// Something lies under the file that it can be reset to.
    pub fn has_base(&self) -> bool {
        self.base.is_some()
    }

    /// Steps that can be taken back, and forward again.
    pub fn steps(&self) -> (usize, usize) {
        (self.done.len(), self.undone.len())
    }

    /// The file says the same.
    pub fn is_saved(&self) -> bool {
        self.now == self.saved
    }

    /// The air that the draft describes, and what of it is hardly meant.
    ///
    /// # Errors
    /// Everything that is wrong with it, a line each.
    pub fn build(&self, overlay: &Overlay, datum: Datum, star: &Starlight) -> Result<(AirSpec, Vec<String>), String> {
        let text = self.object().and_then(|values| write::into_text("", values))?;
        let source = Arc::new(Source { path: self.path.clone(), text });
        let lines = |faults: &[Fault]| -> Vec<String> { faults.iter().map(|f| f.message.clone()).collect() };
        let tree = parse(&source).map_err(|faults| lines(&faults).join("\n"))?;
        let faults = Faults::default();
        let folder = format!("bodies/{}", self.body);
        let air = read_air(&Reader::new(&tree, &faults), datum, &Setting { overlay, folder: &folder, star });
        let found = faults.into_inner();
        if found.iter().any(Fault::is_error) { Err(lines(&found).join("\n")) } else { Ok((air, lines(&found))) }
    }

    fn object(&self) -> Result<&Map<String, Value>, String> {
        self.now.as_object().ok_or_else(|| "expected a table".to_owned())
    }

    /// Writes the file: a patch where something lies under it, else all. A patch that changes nothing goes.
    ///
    /// # Errors
    /// Why it cannot be written; the file is then as it was.
    pub fn save(&mut self) -> Result<(), String> {
        let old = if self.path.is_file() { read_text(&self.path).map_err(|f| f.to_string())?.text.clone() } else { HEAD.to_owned() };
        let text = match &self.base {
            None => write::into_text(&old, self.object()?)?,
            Some(base) => {
                let patch = write::patch(base, &self.now).unwrap_or_else(|| json!({}));
                write::into_text(&old, patch.as_object().ok_or("expected a table")?)?
            }
        };
        let says_nothing = self.base.is_some() && text.lines().all(|l| l.trim().is_empty() || HEAD.contains(l));
        if says_nothing {
            if self.path.is_file() {
                std::fs::remove_file(&self.path).map_err(|e| format!("{}: {e}", self.path.display()))?;
            }
        } else {
            let folder = self.path.parent().unwrap_or(Path::new("."));
            std::fs::create_dir_all(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
            crate::save::file::replace(&self.path, text.as_bytes(), &|_| false).map_err(|e| e.to_string())?;
        }
        self.saved = self.now.clone();
        Ok(())
    }
}

/// The values of files laid over each other.
fn read(files: &[PathBuf]) -> Result<Value, AssetErrors> {
    let mut tree: Option<Node> = None;
    let mut faults = Vec::new();
    for file in files {
        let source = read_text(file).map_err(AssetErrors::one)?;
        let node = parse(&source).map_err(|faults| AssetErrors { faults })?;
        match &mut tree {
            Some(tree) => tree.patch(node, &mut faults),
            none => *none = Some(node),
        }
    }
    let tree = tree.map_or_else(|| json!({}), |t| t.json());
    AssetErrors { faults }.or(tree)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::assets::tests::{AIR, AIR_FILE, assets, put};

    fn overlay(dir: &Path, mods: &[PathBuf]) -> Overlay {
        Overlay::new(dir, mods)
    }

    #[test]
    fn what_is_saved_is_what_was_seen_and_comments_stay() {
        let dir = assets();
        put(dir.path(), AIR_FILE, AIR.replace("[[layers]]\n", "[[layers]]\nname = \"dust\"\n").as_bytes());
        let mods = tempfile::tempdir().unwrap();
        let overlay = overlay(dir.path(), &[mods.path().join("edited")]);
        let mut draft = Draft::open(&overlay, "rock", Target::Mod).unwrap();
        assert!(draft.is_saved() && draft.has_base());
        let mut now = draft.now.clone();
        now["layers"][0]["scattering_per_m"] = json!([1e-5, 2e-5, 4e-5]);
        draft.step(now, false);
        assert!(!draft.is_saved());
        let datum = Datum::new(4.0e14, 6.0e6);
        let star = Starlight::default();
        let (air, _) = draft.build(&overlay, datum, &star).unwrap();
        assert_eq!(air.look.unwrap().medium.layers[0].scattering_per_m, glam::Vec3::new(1e-5, 2e-5, 4e-5));
        draft.save().unwrap();
        let file = mods.path().join("edited/bodies/rock/atmosphere.patch.toml");
        let text = std::fs::read_to_string(&file).unwrap();
        assert_eq!(text, format!("{HEAD}[layers.dust]\nscattering_per_m = [1e-5, 2e-5, 4e-5]\n"));
        std::fs::write(&file, text.replace("[layers.dust]", "# By eye.\n[layers.dust]")).unwrap();
        // What was saved is what is read, and the next edit keeps the comment.
        let mut draft = Draft::open(&overlay, "rock", Target::Mod).unwrap();
        let mut now = draft.now.clone();
        assert_eq!(now["layers"][0]["scattering_per_m"], json!([1e-5, 2e-5, 4e-5]));
        now["top_altitude_m"] = json!(70_000);
        draft.step(now, false);
        draft.save().unwrap();
        let text = std::fs::read_to_string(&file).unwrap();
        assert!(text.contains("# By eye.") && text.contains("top_altitude_m = 70000"), "{text}");
        draft.reset();
        std::fs::write(&file, HEAD).unwrap();
        draft.save().unwrap();
        assert!(!file.exists(), "a patch that changes nothing goes");
    }

    #[test]
    fn a_file_of_the_mod_s_own_is_written_itself_and_safe_mode_has_none() {
        let dir = assets();
        let one = tempfile::tempdir().unwrap();
        let own = put(one.path(), AIR_FILE, format!("# Mine.\n{AIR}").as_bytes());
        let overlay = overlay(dir.path(), &[one.path().to_owned()]);
        let mut draft = Draft::open(&overlay, "rock", Target::Mod).unwrap();
        assert_eq!((draft.path.as_path(), draft.has_base()), (own.as_path(), false));
        let mut now = draft.now.clone();
        now["top_altitude_m"] = json!(9e4);
        draft.step(now, false);
        draft.save().unwrap();
        let text = std::fs::read_to_string(&own).unwrap();
        assert!(text.starts_with("# Mine.\ntop_altitude_m = 90000"), "{text}");
        assert!(Draft::open(&Overlay::new(dir.path(), &[]), "rock", Target::Mod).is_err());
        let own = Draft::open(&Overlay::new(dir.path(), &[]), "rock", Target::Assets).unwrap();
        assert_eq!(own.path, dir.path().join(AIR_FILE));
    }

    #[test]
    fn steps_go_back_and_forward_and_a_held_slider_is_one() {
        let dir = assets();
        let mut draft = Draft::open(&overlay(dir.path(), &[dir.path().join("m")]), "rock", Target::Mod).unwrap();
        let first = draft.now.clone();
        let with = |top: f64| {
            let mut now = first.clone();
            now["top_altitude_m"] = json!(top);
            now
        };
        for (top, held) in [(1e4, true), (2e4, true), (3e4, false), (5e4, false)] {
            draft.step(with(top), held);
        }
        assert_eq!(draft.steps(), (2, 0));
        assert!(draft.undo());
        assert_eq!(draft.now, with(3e4));
        assert!(draft.undo() && !draft.undo());
        assert!(draft.is_saved());
        assert!(draft.redo() && draft.redo() && !draft.redo());
        assert_eq!(draft.now, with(5e4));
        draft.revert();
        assert!(draft.is_saved() && draft.undo());
        assert_eq!(draft.now, with(5e4));
    }

    #[test]
    fn a_file_that_is_written_elsewhere_is_followed_and_an_edit_is_not_lost_to_it() {
        let dir = assets();
        let mods = tempfile::tempdir().unwrap();
        let overlay = overlay(dir.path(), &[mods.path().to_owned()]);
        let mut draft = Draft::open(&overlay, "rock", Target::Mod).unwrap();
        let with = |draft: &Draft, top: Value| {
            let mut now = draft.now.clone();
            now["top_altitude_m"] = top;
            now
        };
        let top = |draft: &Draft| draft.now["top_altitude_m"].as_f64();
        draft.step(with(&draft, json!(70_000)), false);
        draft.save().unwrap();
        draft.follow(&overlay, Target::Mod);
        assert!(draft.is_saved() && draft.steps() == (1, 0), "its own file is no news");
        std::fs::write(&draft.path, "top_altitude_m = 60000.0\n").unwrap();
        draft.follow(&overlay, Target::Mod);
        assert!(draft.is_saved() && top(&draft) == Some(60_000.0));
        assert!(draft.undo() && top(&draft) == Some(70_000.0), "and can be taken back");
        // What is not saved stays, and goes back to the file.
        std::fs::write(&draft.path, "top_altitude_m = 50000.0\n").unwrap();
        draft.follow(&overlay, Target::Mod);
        assert_eq!(top(&draft), Some(70_000.0));
        draft.revert();
        assert!(draft.is_saved() && top(&draft) == Some(50_000.0));
        // A broken file changes nothing here.
        std::fs::write(&draft.path, "top_altitude_m = \n").unwrap();
        draft.follow(&overlay, Target::Mod);
        assert_eq!(top(&draft), Some(50_000.0));
    }

    #[test]
    fn a_body_without_air_may_be_given_one() {
        let dir = assets();
        let mods = tempfile::tempdir().unwrap();
        let overlay = overlay(dir.path(), &[mods.path().to_owned()]);
        let mut draft = Draft::open(&overlay, "moon", Target::Mod).unwrap();
        assert_eq!(draft.now, json!({}));
        draft.step(first_air(5.0e5), false);
        let star = Starlight::default();
        let (air, warnings) = draft.build(&overlay, Datum::new(1e11, 5.0e5), &star).unwrap();
        assert!(air.look.is_some(), "{warnings:?}");
        draft.save().unwrap();
        assert!(mods.path().join("bodies/moon/atmosphere.toml").is_file());
    }
}
