//! Memory that one batch leaves to the next: the system takes long to give it anew.

use super::rays::Row;
use crate::geometry::Hit;
use std::sync::{Mutex, PoisonError};

/// Of one batch or task.
#[derive(Debug, Default)]
pub(super) struct Room {
    pub(super) rows: Vec<Row>,
    /// Best hits, by the number that the row has.
    pub(super) found: Vec<Hit>,
    pub(super) ids: Vec<u32>,
    /// Numbers in the batch of what a task numbers anew.
    pub(super) numbers: Vec<u32>,
    pub(super) starts: Vec<f32>,
}

/// Those that nobody uses.
#[derive(Debug, Default)]
pub(super) struct Rooms(Mutex<Vec<Room>>);

impl Rooms {
    /// Work in a room.
    pub(super) fn with<R>(&self, work: impl FnOnce(&mut Room) -> R) -> R {
        // A thread that panicked leaves no room, and the others whole.
        let lock = || self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let mut room = lock().pop().unwrap_or_default();
        let result = work(&mut room);
        lock().push(room);
        result
    }

    /// Bytes held.
    pub(super) fn bytes(&self) -> usize {
        let rooms = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let words = |r: &Room| 8 * r.rows.capacity() + 4 * r.found.capacity() + r.ids.capacity();
        rooms.iter().map(|r| 4 * (words(r) + r.numbers.capacity() + r.starts.capacity())).sum()
    }
}
