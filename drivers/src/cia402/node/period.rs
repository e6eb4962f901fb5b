//! Period of the bus: value * 10^index s, object 0x60c2, in control periods.

/// The shortest and the longest, in control periods.
const SHORTEST: u32 = 2;
const LONGEST: u32 = 1000;

#[derive(Clone, Copy, Debug)]
pub(super) struct Period {
    value: u8,
    index: i8,
    periods: u32,
}

impl Period {
    /// 1 ms, which has so many control periods.
    pub(super) const fn millisecond(periods: u32) -> Self {
        Self { value: 1, index: -3, periods }
    }

    /// `None` unless it is a whole number of control periods, of which a second has `rate`, at most 10^6.
    pub(super) fn new(value: u8, index: i8, rate: u32) -> Option<Self> {
        let per_second = match index {
            0 => 1,
            -1 => 10,
            -2 => 100,
            -3 => 1000,
            -4 => 10_000,
            -5 => 100_000,
            -6 => 1_000_000,
            _ => return None,
        };
        let product = u32::from(value).checked_mul(rate)?;
        let whole = product.checked_rem(per_second)? == 0;
        let periods = product.checked_div(per_second)?;
        (whole && (SHORTEST..=LONGEST).contains(&periods)).then_some(Self { value, index, periods })
    }

    pub(super) fn value(&self) -> u8 {
        self.value
    }

    pub(super) fn index(&self) -> i8 {
        self.index
    }

    pub(super) fn periods(&self) -> u32 {
        self.periods
    }
}
