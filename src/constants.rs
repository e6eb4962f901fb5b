//! Built models as constants: fields of fixed width, laid out alike on the host that builds them and on the target that
//! reads them in place.

pub(crate) use strainwave_derive::constants;

/// Built model that can be written as it lies in the target's memory, little-endian.
pub(crate) trait Constants {
    /// Fingerprint of the names and types of all fields in their order: that of another layout differs.
    const FINGERPRINT: u32;

    /// Writes the model into bytes of its size; padding is left as it is.
    fn write(&self, bytes: &mut [u8]);
}

/// Numbers, by their name and their little-endian bytes.
macro_rules! numbers {
    ($($number:ty)*) => {
        $(impl Constants for $number {
            const FINGERPRINT: u32 = fingerprint(START, stringify!($number).as_bytes());

            fn write(&self, bytes: &mut [u8]) {
                bytes.copy_from_slice(&self.to_le_bytes());
            }
        })*
    };
}

numbers!(f32 i16 i32 u32);

impl Constants for bool {
    const FINGERPRINT: u32 = fingerprint(START, b"bool");

    fn write(&self, bytes: &mut [u8]) {
        bytes.copy_from_slice(&[u8::from(*self)]);
    }
}

impl<T: Constants, const N: usize> Constants for [T; N] {
    const FINGERPRINT: u32 =
        fingerprint(fingerprint(START, &T::FINGERPRINT.to_le_bytes()), &(N as u32).to_le_bytes());

    fn write(&self, bytes: &mut [u8]) {
        for (element, bytes) in self.iter().zip(bytes.chunks_exact_mut(size_of::<T>())) {
            element.write(bytes);
        }
    }
}

/// Fingerprint of a struct with fields of these names and fingerprints.
pub(crate) const fn fingerprint_of_fields(fields: &[(&str, u32)]) -> u32 {
    let mut sum = START;
    let mut k = 0;
    while k < fields.len() {
        let (name, of_type) = fields[k];
        sum = fingerprint(fingerprint(sum, name.as_bytes()), &of_type.to_le_bytes());
        k += 1;
    }
    sum
}

/// Start of a fingerprint.
pub(crate) const START: u32 = 0x811c_9dc5;

/// Continues a fingerprint by bytes: FNV-1a, 32 bits. G. Fowler, L. Noll, K.-P. Vo, D. Eastlake, IETF draft (2012).
pub(crate) const fn fingerprint(mut sum: u32, bytes: &[u8]) -> u32 {
    let mut k = 0;
    while k < bytes.len() {
        sum = (sum ^ bytes[k] as u32).wrapping_mul(0x0100_0193);
        k += 1;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[constants]
    struct Inner<R, const N: usize> {
        table: [i16; N],
        gain: R,
    }

    #[constants]
    struct Outer {
        on: bool,
        inner: Inner<f32, 3>,
        count: u32,
    }

    #[constants]
    struct Renamed {
        on: bool,
        inner: Inner<f32, 3>,
        number: u32,
    }

    #[constants]
    struct Pair<T>(T, T);

    #[test]
    fn fields_are_written_where_they_lie_and_padding_is_left() {
        let outer = Outer { on: true, inner: Inner { table: [1, -1, 2], gain: 1.0 }, count: 0x0403_0201 };
        let mut bytes = [0; size_of::<Outer>()];
        outer.write(&mut bytes);
        assert_eq!(bytes, [1, 0, 0, 0, 1, 0, 255, 255, 2, 0, 0, 0, 0, 0, 128, 63, 1, 2, 3, 4]);
        // As it is read in place.
        use zerocopy::TryFromBytes;
        let read = Outer::try_read_from_bytes(&bytes).unwrap();
        assert!(read.on && read.inner.table == outer.inner.table && read.count == outer.count);
        bytes[0] = 2;
        assert!(Outer::try_read_from_bytes(&bytes).is_err());
    }

    #[test]
    fn a_name_a_type_and_a_size_make_another_fingerprint() {
        let prints = [
            Outer::FINGERPRINT,
            Renamed::FINGERPRINT,
            Inner::<f32, 3>::FINGERPRINT,
            Inner::<f32, 4>::FINGERPRINT,
            Inner::<u32, 3>::FINGERPRINT,
            Pair::<bool>::FINGERPRINT,
            <[bool; 2]>::FINGERPRINT,
        ];
        for (k, print) in prints.iter().enumerate() {
            assert!(!prints[..k].contains(print), "{k}");
        }
    }

    #[test]
    fn the_fingerprint_is_fnv_1a() {
        // Test vectors of the draft.
        assert_eq!((fingerprint(START, b""), fingerprint(START, b"a")), (0x811c_9dc5, 0xe40c_292c));
        assert_eq!(fingerprint(START, b"foobar"), 0xbf9c_f968);
    }
}
