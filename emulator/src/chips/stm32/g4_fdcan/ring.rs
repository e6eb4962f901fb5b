//! Three elements of the message RAM that are used in turn.

/// How many.
pub const SIZE: u32 = 3;

/// Which of them are in use.
#[derive(Clone, Copy, Debug, Default)]
pub struct Ring {
    first: u32,
    fill: u32,
}

impl Ring {
    /// The oldest that is in use.
    pub fn first(self) -> u32 {
        self.first
    }

    /// The next that will be.
    pub fn next(self) -> u32 {
        (self.first + self.fill) % SIZE
    }

    /// How many are in use.
    pub fn fill(self) -> u32 {
        self.fill
    }

    /// How many are not.
    pub fn free(self) -> u32 {
        SIZE - self.fill
    }

    /// Those in use, a bit each.
    pub fn mask(self) -> u32 {
        (0..self.fill).fold(0, |mask, after| mask | 1 << ((self.first + after) % SIZE))
    }

    /// Takes the next into use, if one is free.
    pub fn push(&mut self) -> Option<u32> {
        let next = self.next();
        (self.free() > 0).then(|| {
            self.fill += 1;
            next
        })
    }

    /// Frees the oldest up to that one; nothing, where that one is not in use.
    pub fn free_up_to(&mut self, last: u32) {
        if last < SIZE && self.mask() & 1 << last != 0 {
            let freed = (last + SIZE - self.first) % SIZE + 1;
            (self.first, self.fill) = ((last + 1) % SIZE, self.fill - freed);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn elements_are_used_in_turn() {
        let mut ring = Ring::default();
        assert_eq!([(); 4].map(|()| ring.push()), [Some(0), Some(1), Some(2), None]);
        ring.free_up_to(1);
        assert_eq!((ring.first(), ring.fill(), ring.mask()), (2, 1, 0b100));
        assert_eq!((ring.push(), ring.mask(), ring.free()), (Some(0), 0b101, 1));
        ring.free_up_to(1);
        ring.free_up_to(7);
        assert_eq!((ring.first(), ring.fill()), (2, 2));
        ring.free_up_to(0);
        assert_eq!((ring.first(), ring.next(), ring.fill()), (1, 1, 0));
    }
}
