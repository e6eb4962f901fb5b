//! Values of registers.

/// What one of an integer register stands for, as int8, int16 and int32.
pub(super) type Scales = [f32; 3];
pub(super) const REVOLUTIONS: Scales = [0.01, 0.0001, 0.00001];
pub(super) const REVOLUTIONS_PER_SECOND: Scales = [0.1, 0.00025, 0.00001];
pub(super) const NEWTON_METRES: Scales = [0.5, 0.01, 0.001];

/// A register's value as it comes.
#[derive(Clone, Copy)]
pub(super) enum Value {
    Int8(i8),
    Int16(i16),
    Int32(i32),
    Float(f32),
}

impl Value {
    /// The value of this kind of subframe, and what is behind it.
    pub(super) fn take(kind: u8, data: &[u8]) -> Option<(Self, &[u8])> {
        Some(match kind >> 2 & 3 {
            0 => taken(data, |bytes| Self::Int8(i8::from_le_bytes(bytes)))?,
            1 => taken(data, |bytes| Self::Int16(i16::from_le_bytes(bytes)))?,
            2 => taken(data, |bytes| Self::Int32(i32::from_le_bytes(bytes)))?,
            _ => taken(data, |bytes| Self::Float(f32::from_le_bytes(bytes)))?,
        })
    }

    /// A mode or a fault code.
    pub(super) fn code(self) -> Option<u8> {
        match self {
            Self::Int8(code) => code.try_into().ok(),
            Self::Int16(code) => code.try_into().ok(),
            Self::Int32(code) => code.try_into().ok(),
            Self::Float(_) => None,
        }
    }

    /// Of an integer type the lowest value is "not a number".
    pub(super) fn quantity(self, [int8, int16, int32]: Scales) -> Option<f32> {
        match self {
            Self::Int8(value) => (value != i8::MIN).then_some(f32::from(value) * int8),
            Self::Int16(value) => (value != i16::MIN).then_some(f32::from(value) * int16),
            Self::Int32(value) => (value != i32::MIN).then_some(value as f32 * int32),
            Self::Float(value) => Some(value),
        }
    }
}

fn taken<const N: usize>(data: &[u8], value: impl FnOnce([u8; N]) -> Value) -> Option<(Value, &[u8])> {
    let (bytes, rest) = data.split_first_chunk()?;
    Some((value(*bytes), rest))
}

/// A number of at most 32 bits in at most 5 bytes, and what is behind it.
pub(super) fn varuint(data: &[u8]) -> Option<(u32, &[u8])> {
    let (mut number, mut rest) = (0, data);
    for shift in [0, 7, 14, 21, 28] {
        let (&byte, behind) = rest.split_first()?;
        number |= u32::from(byte & 0x7f) << shift;
        rest = behind;
        if byte & 0x80 == 0 {
            return Some((number, rest));
        }
    }
    None
}
