//! The store, with the power cut in every step of every write.

use std::vec::Vec;

use super::flash::{Flash, PAGE};
use crate::store::{Owner, Record, Store};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use strainwave::compensator::words::{LEARNT_LAYOUT, LEARNT_WORDS};

/// Pages of an area, and the whole of the store.
const PAGES: usize = 1;
const REGION: std::ops::Range<u32> = 0..(2 * PAGES * PAGE) as u32;
const OWNER: Owner = Owner { layout: LEARNT_LAYOUT, joint: 0x1234_5678 };

/// What cuts have led to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cuts {
    /// Cuts of the power.
    pub cuts: u64,
    /// After which neither the old nor the new words were there.
    pub neither: u64,
    /// After which the store could not be written again.
    pub stuck: u64,
}

impl Cuts {
    /// Both.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        Self {
            cuts: self.cuts + other.cuts,
            neither: self.neither + other.neither,
            stuck: self.stuck + other.stuck,
        }
    }
}

type Learnt<'a> = Store<&'a mut Flash, LEARNT_WORDS>;

fn store(flash: &mut Flash) -> Learnt<'_> {
    Store::new(flash, REGION, OWNER).expect("the region holds two areas")
}

/// Stores random words so many times in a flash that holds anything at first; each time the power is also cut in every step on the way, on a copy
/// that is then read and written again.
pub fn cut_everywhere(writes: u32, seed: u64) -> Cuts {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let rubbish: Vec<u8> = (0..2 * PAGES * PAGE).map(|_| random.random()).collect();
    let mut flash = Flash::new(2 * PAGES, &rubbish, ChaCha8Rng::seed_from_u64(seed ^ 1));
    let (mut old, mut found) = (None, Cuts::default());
    for _ in 0..writes {
        let words = words(&mut random);
        let before = flash.clone();
        let sequence = store(&mut flash).write(&words).expect("the power is on");
        let new = Some(Record { sequence, words });
        for cut in 0..=flash.steps() - before.steps() {
            found.cuts += 1;
            cut_once(&before, cut, [old, new], &mut found);
        }
        old = new;
    }
    found
}

/// A cut after so many steps of the write that leads from the old record to the new one.
fn cut_once(before: &Flash, cut: usize, [old, new]: [Option<Record<LEARNT_WORDS>>; 2], found: &mut Cuts) {
    let mut flash = before.clone();
    let words = new.map_or([0; LEARNT_WORDS], |new| new.words);
    flash.cut_after(cut);
    let written = store(&mut flash).write(&words);
    flash.power_on();
    let after = store(&mut flash).read();
    let kept = if written.is_ok() { after == Ok(new) } else { after == Ok(old) || after == Ok(new) };
    found.neither += u64::from(!kept);
    let again = store(&mut flash).write(&words).is_ok();
    let there = store(&mut flash).read().is_ok_and(|record| record.is_some_and(|there| there.words == words));
    found.stuck += u64::from(!(again && there));
}

/// Words with runs of zeros and of erased bytes among them.
fn words(random: &mut ChaCha8Rng) -> [u32; LEARNT_WORDS] {
    let kind = random.random_range(0..4);
    std::array::from_fn(|place| match kind {
        0 => 0,
        1 => u32::MAX,
        2 if place > LEARNT_WORDS / 2 => u32::MAX,
        _ => random.random(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::store::Error;

    fn flash(seed: u64) -> Flash {
        Flash::new(2 * PAGES, &[0xff], ChaCha8Rng::seed_from_u64(seed))
    }

    #[test]
    fn a_cut_leaves_the_old_words_or_the_new_ones() {
        let found = cut_everywhere(100, 7);
        assert!(found.cuts > 100 * u64::from(Learnt::RECORD), "{found:?}");
        assert_eq!((found.neither, found.stuck), (0, 0));
    }

    #[test]
    fn the_test_sees_a_store_that_loses_its_words() {
        let mut before = flash(1);
        let words = [3; LEARNT_WORDS];
        store(&mut before).write(&words).unwrap();
        let mut found = Cuts::default();
        let other = Some(Record { sequence: 1, words: [4; LEARNT_WORDS] });
        cut_once(&before, 3, [other, other], &mut found);
        assert_eq!(found.neither, 1);
    }

    #[test]
    fn every_record_is_read_back_and_areas_take_turns() {
        let mut flash = flash(2);
        assert_eq!(store(&mut flash).read(), Ok(None));
        assert_eq!(Learnt::RECORD, 128);
        let in_area = PAGE as u32 / Learnt::RECORD;
        for number in 1..=5 * in_area {
            let words = [number; LEARNT_WORDS];
            assert_eq!(store(&mut flash).write(&words), Ok(number));
            assert_eq!(store(&mut flash).read(), Ok(Some(Record { sequence: number, words })));
        }
        // An erasure of an area for as many records as it holds.
        let written = 5 * in_area * Learnt::RECORD;
        assert_eq!(flash.steps(), written as usize + 5 * PAGE / 32);
        store(&mut flash).erase().unwrap();
        assert_eq!(store(&mut flash).read(), Ok(None));
    }

    #[test]
    fn what_is_another_joints_or_of_another_layout_is_neither_read_nor_overwritten() {
        let words = [5; LEARNT_WORDS];
        let others =
            [(Owner { joint: 1, ..OWNER }, Error::Joint), (Owner { layout: 1, ..OWNER }, Error::Layout)];
        for (owner, error) in others {
            let mut flash = flash(3);
            Learnt::new(&mut flash, REGION, owner).unwrap().write(&words).unwrap();
            let bytes = flash.bytes().to_vec();
            assert_eq!(store(&mut flash).read(), Err(error));
            assert_eq!(store(&mut flash).write(&words), Err(error));
            assert_eq!(flash.bytes(), bytes);
            store(&mut flash).erase().unwrap();
            assert_eq!(store(&mut flash).write(&words), Ok(1));
        }
    }

    #[test]
    fn a_record_of_another_length_is_of_another_layout() {
        let mut flash = flash(4);
        let mut longer = Store::<_, 60>::new(&mut flash, REGION, OWNER).unwrap();
        for number in 0..5 {
            longer.write(&[number; 60]).unwrap();
        }
        assert_eq!(store(&mut flash).read(), Err(Error::Layout));
    }

    #[test]
    fn a_bit_that_has_changed_gives_the_record_before() {
        let mut flash = flash(5);
        for number in 1..=2 {
            store(&mut flash).write(&[number; LEARNT_WORDS]).unwrap();
        }
        let record = Learnt::RECORD as usize;
        for place in 0..4 * (5 + LEARNT_WORDS) {
            for bit in 0..8 {
                flash.bytes()[record + place] ^= 1 << bit;
                let read = store(&mut flash).read().unwrap().unwrap();
                assert_eq!(read.words, [1; LEARNT_WORDS], "byte {place}");
                flash.bytes()[record + place] ^= 1 << bit;
            }
        }
    }

    #[test]
    fn a_region_that_cannot_hold_two_records_is_refused() {
        let page = PAGE as u32;
        for region in [0..page, 8..2 * page + 8, 0..3 * page, 0..4 * page, page..0] {
            let mut flash = flash(6);
            let found = Learnt::new(&mut flash, region.clone(), OWNER);
            assert_eq!(found.err(), Some(Error::Region), "{region:?}");
        }
    }

    /// The constants of a joint are words, too: several pages of them.
    #[test]
    fn the_constants_of_a_joint_survive_a_cut() {
        use crate::simulation::joint::default_joint;
        use strainwave::compensator::Compensator;
        use strainwave::compensator::words::{LAYOUT, WORDS, identity};

        const PAGES: usize = (4 * WORDS + 32).div_ceil(PAGE);

        fn open(flash: &mut Flash, owner: Owner) -> Store<&mut Flash, WORDS> {
            Store::new(flash, 0..(2 * PAGES * PAGE) as u32, owner).unwrap()
        }

        let words = default_joint().to_words();
        let mut flash = Flash::new(2 * PAGES, &[0xff], ChaCha8Rng::seed_from_u64(8));
        let owner = Owner { layout: LAYOUT, joint: identity(&words) };
        open(&mut flash, owner).write(&words).unwrap();
        for cut in (1..4 * WORDS).step_by(97) {
            flash.cut_after(cut);
            assert_eq!(open(&mut flash, owner).write(&[0; WORDS]), Err(Error::Flash));
            flash.power_on();
            let read = open(&mut flash, owner).read().unwrap().unwrap();
            assert_eq!(Compensator::from_words(&read.words), Ok(&default_joint()), "{cut}");
        }
    }
}
