//! `1 - e^-x`: how much of an exponential approach is covered, in a dozen operations and without a branch.
//!
//! ```text
//! x = k/32 + r, |r| <= 1/64        1 - e^-x = U_k + (1 - U_k)*(1 - e^-r),   U_k = 1 - e^(-k/32)
//! ```
//!
//! k is found by adding a number so large that the sum's last digit is worth 1/32; U_k is a table, and
//! `(1 - e^-r)/r` a polynomial: for f32 its series up to r^2 (1.6e-7 relative before rounding), for f64 the
//! minimax of degree 5 (9.1e-17). Near 0 the table is exactly 0, so that small x keep their relative accuracy;
//! from the end of the table on, x = 16 in f32 and 37.5 in f64, the answer is exactly 1.

/// Entries of the tables in one unit of x.
const PER_UNIT: usize = 32;
/// Entries; the last is 1. In f32 that is 1e-7 too much, but an index below a power of two is one instruction.
const SINGLE: usize = 16 * PER_UNIT;
const DOUBLE: usize = 2048;
/// Entry from which on e^-x is below half a digit of 1.
const DOUBLE_END: usize = 37 * PER_UNIT + PER_UNIT / 2;

/// Bytes of the table for f32.
pub const SINGLE_BYTES: usize = SINGLE * size_of::<f32>();

/// U_k.
static SINGLE_TABLE: [f32; SINGLE] = {
    let mut table = [0.0; SINGLE];
    let mut k = 0;
    while k < SINGLE {
        table[k] = exact(k as f64 / PER_UNIT as f64) as f32;
        k += 1;
    }
    table[SINGLE - 1] = 1.0;
    table
};

static DOUBLE_TABLE: [f64; DOUBLE] = {
    let mut table = [0.0; DOUBLE];
    let mut k = 0;
    while k <= DOUBLE_END {
        table[k] = exact(k as f64 / PER_UNIT as f64);
        k += 1;
    }
    table
};

/// `1 - e^-x` for x >= 0 within a few units of rounding: the series at a small fraction of x, which is then
/// doubled, E(2y) = E(y)*(2 - E(y)).
const fn exact(x: f64) -> f64 {
    let (mut y, mut doublings) = (x, 0);
    while y > 0.125 {
        y *= 0.5;
        doublings += 1;
    }
    let (mut series, mut order) = (1.0, 13.0);
    while order > 1.0 {
        series = 1.0 - series * y / order;
        order -= 1.0;
    }
    let mut covered = y * series;
    while doublings > 0 {
        covered *= 2.0 - covered;
        doublings -= 1;
    }
    covered
}

/// For a finite x >= 0.
#[inline(always)]
pub fn one_minus_exp_neg_f32(x: f32) -> f32 {
    /// Its last digit is worth 1/32.
    const GRID: f32 = 1.5 * (1u32 << 18) as f32;
    let on_grid = x + GRID;
    let k = on_grid.to_bits().cast_signed().wrapping_sub(GRID.to_bits().cast_signed());
    let entry = SINGLE_TABLE[k.clamp(0, SINGLE as i32 - 1) as usize];
    let rest = x + (GRID - on_grid);
    let ratio = 1.0 + rest * (-0.5 + rest * (1.0 / 6.0));
    entry + (1.0 - entry) * (rest * ratio)
}

/// For a finite x >= 0.
#[inline(always)]
pub fn one_minus_exp_neg_f64(x: f64) -> f64 {
    /// Its last digit is worth 1/32.
    const GRID: f64 = 1.5 * (1u64 << 47) as f64;
    const C: [f64; 4] = [
        0.166_666_666_660_014_34,
        -0.041_666_666_665_835_13,
        8.333_405_994_510_81e-3,
        -1.388_897_971_529_144e-3,
    ];
    // Limited as a number, which vectorises; the mask is no more than a proof to the compiler.
    let x = x.min(DOUBLE_END as f64 / PER_UNIT as f64);
    let on_grid = x + GRID;
    let k = on_grid.to_bits().wrapping_sub(GRID.to_bits()) as usize;
    let entry = DOUBLE_TABLE[k % DOUBLE];
    let rest = x + (GRID - on_grid);
    // Pairs first (Estrin): the chain of dependent operations is short, and several run at once.
    let square = rest * rest;
    let high = (C[0] + rest * C[1]) + square * (C[2] + rest * C[3]);
    let ratio = (1.0 - 0.5 * rest) + square * high;
    entry + ((1.0 - entry) * rest) * ratio
}
