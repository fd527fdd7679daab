//! The cache: what was integrated, as bytes, so that it need not be integrated again.
//!
//! A cache is never trusted: it carries the hash of all that the system is made from, a checksum of its own, and its first chunks must be
//! bit for bit those that this program makes from the same start. Whatever fails is thrown away and integrated again.
//! Layout: magic, version, key; each level: ticks of a chunk, points, tracks; each of its two sides: checkpoints, and chunks where they are
//! kept; blake3 of all before. Numbers little-endian. Not here: files (`game`).

use super::chunk::{Chunk, Piece, TERMS};
use super::handle::{Ephemeris, System};
use super::level::Checkpoint;
use super::orbit::{Details, Orbit};
use glam::DVec3;

const MAGIC: [u8; 8] = *b"SYZYPATH";
/// Version of the layout.
const VERSION: u32 = 1;

/// Why a cache is not taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CacheError {
    /// No cache, or of another layout.
    #[error("not a cache of this version")]
    Layout,
    /// Made from other bodies.
    #[error("made from another system")]
    Foreign,
    /// The checksum does not fit, or a number is none.
    #[error("damaged")]
    Damaged,
    /// Its first chunks are not those that this program makes.
    #[error("made by another version of the program")]
    Other,
}

/// Hash of what a system is made from. `{:?}` of an f64 is its shortest exact form.
pub(super) fn key(orbits: &[Orbit], details: &Details) -> [u8; 32] {
    *blake3::hash(format!("{orbits:?}{details:?}").as_bytes()).as_bytes()
}

/// Writes numbers.
#[derive(Default)]
struct Out(Vec<u8>);

impl Out {
    #[allow(clippy::cast_possible_truncation)]
    fn count(&mut self, n: usize) {
        self.0.extend_from_slice(&(n as u32).to_le_bytes());
    }
    fn points(&mut self, list: &[DVec3]) {
        for x in list.iter().flat_map(|p| p.to_array()) {
            self.0.extend_from_slice(&x.to_le_bytes());
        }
    }
}

/// Reads them; `None` past the end or where a number is not finite.
struct In<'a>(&'a [u8]);

impl In<'_> {
    fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (head, rest) = self.0.split_first_chunk::<N>()?;
        self.0 = rest;
        Some(*head)
    }
    fn count(&mut self) -> Option<usize> {
        self.take().map(|b| u32::from_le_bytes(b) as usize)
    }
    fn points(&mut self, n: usize) -> Option<Vec<DVec3>> {
        // Refused before memory is asked for.
        if self.0.len() / 24 < n {
            return None;
        }
        let mut number = || self.take().map(f64::from_le_bytes).filter(|x| x.is_finite());
        (0..n).map(|_| Some(DVec3::new(number()?, number()?, number()?))).collect()
    }
}

/// One side of a level as it was read.
struct Side {
    level: usize,
    side: usize,
    checkpoints: Vec<Checkpoint>,
    chunks: Vec<Chunk>,
}

impl Ephemeris {
    /// Everything that has been integrated, to be given to [`Ephemeris::from_bytes`] of the same system later.
    pub fn to_bytes(&self) -> Vec<u8> {
        let Some(system) = self.system.as_deref() else { return Vec::new() };
        let mut out = Out(MAGIC.to_vec());
        out.0.extend_from_slice(&VERSION.to_le_bytes());
        out.0.extend_from_slice(&system.key);
        for level in &system.levels {
            for side in 0..2 {
                let checkpoints = level.checkpoints(side);
                out.count(checkpoints.len());
                for c in &checkpoints {
                    out.points(&c.q);
                    out.points(&c.v);
                }
                if !level.keeps() {
                    continue;
                }
                for k in 0..checkpoints.len() - 1 {
                    let empty = Chunk::default();
                    let chunk = level.kept(number(side, k)).unwrap_or(&empty);
                    for piece in &chunk.pieces {
                        out.0.extend_from_slice(&[piece.terms, piece.halvings]);
                    }
                    out.points(&chunk.coefficients);
                }
            }
        }
        let sum = blake3::hash(&out.0);
        out.0.extend_from_slice(sum.as_bytes());
        out.0
    }

    /// Takes over what another handle of the same system has integrated (its files were read again); of another system nothing.
    pub fn take_over(&self, other: &Self) {
        if let (Some(a), Some(b)) = (&self.system, &other.system)
            && a.key == b.key
        {
            // Checked like any cache: that costs milliseconds.
            let _ = self.from_bytes(&other.to_bytes());
        }
    }

    /// Takes over what [`Ephemeris::to_bytes`] of the same system gave, where it reaches further than what is there.
    ///
    /// # Errors
    /// Why it is not taken; nothing has changed then.
    pub fn from_bytes(&self, bytes: &[u8]) -> Result<(), CacheError> {
        let Some(system) = self.system.as_deref() else { return Err(CacheError::Foreign) };
        let (body, sum) = bytes.split_last_chunk::<32>().ok_or(CacheError::Layout)?;
        let mut input = In(body);
        if input.take() != Some(MAGIC) || input.take().map(u32::from_le_bytes) != Some(VERSION) {
            return Err(CacheError::Layout);
        }
        if input.take() != Some(system.key) {
            return Err(CacheError::Foreign);
        }
        if blake3::hash(body) != *sum {
            return Err(CacheError::Damaged);
        }
        let sides = read(system, &mut input).ok_or(CacheError::Damaged)?;
        if !sides.iter().all(|side| side.is_ours(system)) {
            return Err(CacheError::Other);
        }
        for s in sides {
            system.levels[s.level].adopt(s.side, s.checkpoints, s.chunks);
        }
        Ok(())
    }
}

/// The k-th chunk of a side.
fn number(side: usize, k: usize) -> i64 {
    let k = i64::try_from(k).unwrap_or(i64::MAX - 1);
    if side == 0 { k } else { -1 - k }
}

fn read(system: &System, input: &mut In<'_>) -> Option<Vec<Side>> {
    let mut sides = Vec::new();
    for (index, level) in system.levels.iter().enumerate() {
        let (points, tracks) = (level.start().q.len(), level.bodies.len());
        for side in 0..2 {
            let count = input.count()?;
            if count == 0 || i64::try_from(count).ok()? > level.reach + 1 {
                return None;
            }
            let mut checkpoints = Vec::new();
            for _ in 0..count {
                checkpoints.push(Checkpoint { q: input.points(points)?, v: input.points(points)? });
            }
            let mut chunks = Vec::new();
            for _ in 0..if level.keeps() { count - 1 } else { 0 } {
                chunks.push(read_chunk(tracks, input)?);
            }
            sides.push(Side { level: index, side, checkpoints, chunks });
        }
    }
    input.0.is_empty().then_some(sides)
}

fn read_chunk(tracks: usize, input: &mut In<'_>) -> Option<Chunk> {
    let mut pieces = Vec::with_capacity(tracks);
    let mut total = 0_u32;
    for _ in 0..tracks {
        let [terms, halvings] = input.take()?;
        if terms == 0 || usize::from(terms) > TERMS || u32::from(halvings) > super::chunk::DEEPEST {
            return None;
        }
        pieces.push(Piece { first: total, terms, halvings });
        total = total.checked_add(u32::from(terms) << halvings)?;
    }
    Some(Chunk { pieces, coefficients: input.points(total as usize)? })
}

impl Side {
    /// True when it starts where the system does and its first step outwards is the one that this program makes.
    fn is_ours(&self, system: &System) -> bool {
        let level = &system.levels[self.level];
        if self.checkpoints.first() != Some(&level.start()) {
            return false;
        }
        let Some(second) = self.checkpoints.get(1) else { return true };
        let n = number(self.side, 0);
        level.grow(system, number(self.side, if level.keeps() { 0 } else { 1 }));
        let same = level.checkpoints(self.side).get(1) == Some(second);
        same && (!level.keeps() || level.kept(n) == self.chunks.first())
    }
}
