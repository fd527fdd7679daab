//! Which tiles are resident: a fixed number of slots, the least recently drawn given up first.
//!
//! A frame asks for its set; new tiles are granted up to a budget, coarse ones first. Where a wanted tile is not there yet its
//! nearest resident ancestor is drawn instead, in place of everything below that ancestor: never a hole, never two grounds.
//! Not here: what a slot holds (`render/pass/tile_heights.rs`).

use super::tile::TileKey;
use std::collections::BTreeMap;

/// Slot of a resident tile.
pub type Slot = u32;

#[derive(Clone, Copy, Debug)]
struct Resident {
    slot: Slot,
    used: u64,
}

/// Slots and who sits in them.
#[derive(Clone, Debug)]
pub struct Residency {
    slots: u32,
    seated: BTreeMap<TileKey, Resident>,
    free: Vec<Slot>,
    clock: u64,
}

/// What to do for one frame.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Plan {
    /// Tiles whose heights must be computed, with their slots.
    pub make: Vec<(TileKey, Slot)>,
    /// Tiles to draw, with their slots.
    pub draw: Vec<(TileKey, Slot)>,
    /// Wanted tiles that had to wait.
    pub waiting: usize,
}

impl Residency {
    /// An empty house of `slots`.
    pub fn new(slots: u32) -> Self {
        Self { slots, seated: BTreeMap::new(), free: (0..slots).rev().collect(), clock: 0 }
    }
    /// Slots in all.
    pub fn slots(&self) -> u32 {
        self.slots
    }
    /// Tiles resident.
    pub fn resident(&self) -> usize {
        self.seated.len()
    }
    /// Forgets all tiles.
    pub fn clear(&mut self) {
        *self = Self::new(self.slots);
    }

    /// Seats the wanted tiles and their ancestors' stand-ins, making at most `budget` new ones.
    pub fn plan(&mut self, wanted: &[TileKey], budget: usize) -> Plan {
        self.clock += 1;
        let mut plan = Plan::default();
        // The roots are always there, so that every tile has an ancestor to fall back on.
        for root in TileKey::roots() {
            self.seat(root, usize::MAX, &mut plan);
        }
        for key in wanted.iter().filter(|k| self.seated.contains_key(k)).copied().collect::<Vec<_>>() {
            self.touch(key);
        }
        let mut stand_ins: Vec<TileKey> = Vec::new();
        for key in wanted {
            if self.seat(*key, budget.saturating_add(6), &mut plan).is_none() {
                plan.waiting += 1;
                let mut up = key.parent();
                while up.level > 0 && !self.seated.contains_key(&up) {
                    up = up.parent();
                }
                stand_ins.push(up);
            }
        }
        stand_ins.sort_unstable();
        stand_ins.dedup();
        let covered = |key: TileKey, itself: bool| {
            let mut up = key;
            loop {
                if (itself || up != key) && stand_ins.binary_search(&up).is_ok() {
                    return true;
                }
                if up.level == 0 {
                    return false;
                }
                up = up.parent();
            }
        };
        let drawn = wanted.iter().filter(|k| !covered(**k, true)).chain(stand_ins.iter().filter(|k| !covered(**k, false)));
        for key in drawn.copied().collect::<Vec<_>>() {
            if let Some(slot) = self.touch(key) {
                plan.draw.push((key, slot));
            }
        }
        plan
    }

    fn touch(&mut self, key: TileKey) -> Option<Slot> {
        let clock = self.clock;
        self.seated.get_mut(&key).map(|r| {
            r.used = clock;
            r.slot
        })
    }

    fn seat(&mut self, key: TileKey, budget: usize, plan: &mut Plan) -> Option<Slot> {
        if let Some(slot) = self.touch(key) {
            return Some(slot);
        }
        if plan.make.len() >= budget {
            return None;
        }
        let slot = self.free.pop().or_else(|| self.evict())?;
        self.seated.insert(key, Resident { slot, used: self.clock });
        plan.make.push((key, slot));
        Some(slot)
    }

    fn evict(&mut self) -> Option<Slot> {
        let oldest = self.seated.iter().filter(|(k, r)| k.level > 0 && r.used < self.clock).min_by_key(|(k, r)| (r.used, **k));
        let key = *oldest?.0;
        self.seated.remove(&key).map(|r| r.slot)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sixteen() -> Vec<TileKey> {
        TileKey::roots()[0].children().into_iter().flat_map(TileKey::children).collect()
    }

    #[test]
    fn what_is_missing_is_covered_by_one_ancestor() {
        let mut house = Residency::new(64);
        let wanted = sixteen();
        let plan = house.plan(&wanted, 0);
        assert_eq!(plan.make.len(), 6, "only the roots");
        assert_eq!(plan.draw, vec![(TileKey::roots()[0], plan.make[0].1)]);
        assert_eq!(plan.waiting, 16);
        let plan = house.plan(&wanted, 100);
        assert_eq!((plan.make.len(), plan.draw.len(), plan.waiting), (16, 16, 0));
        assert!(house.plan(&wanted, 100).make.is_empty(), "nothing new: nothing computed");
    }

    #[test]
    fn the_least_recently_drawn_leaves_and_slots_stay_unique() {
        let mut house = Residency::new(24);
        house.plan(&sixteen(), 100);
        let other: Vec<_> = TileKey::roots()[2].children().into_iter().flat_map(TileKey::children).collect();
        let plan = house.plan(&other, 100);
        assert_eq!(plan.draw.len(), 16);
        let mut slots: Vec<_> = plan.draw.iter().map(|d| d.1).collect();
        slots.sort_unstable();
        slots.dedup();
        assert_eq!(slots.len(), 16);
        assert_eq!(house.resident(), 24);
    }
}
