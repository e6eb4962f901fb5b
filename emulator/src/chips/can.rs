//! A data frame of a classic CAN bus with an identifier of 11 bits, and its bits there.

use embedded_can::Frame as _;
pub use strainwave_app::commanded::Frame as CanFrame;

/// Recessive bits between two frames.
pub const INTERMISSION: u64 = 3;

/// Bits of a frame from its start to its end, with as many stuffed ones as there can be: after five equal bits one, which counts for the next five,
/// from the start to the end of the CRC.
pub fn bits(frame: &CanFrame) -> u64 {
    let data = 8 * frame.dlc() as u64;
    44 + data + (34 + data - 1) / 4
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 135 bits are the known most of a frame of 8 bytes with what follows it.
    #[test]
    fn it_has_at_most_the_bits_of_the_standard() {
        assert_eq!(bits(&CanFrame::of(0, &[0; 8]).unwrap()) + INTERMISSION, 135);
        assert_eq!(bits(&CanFrame::of(0, &[]).unwrap()), 52);
    }
}
