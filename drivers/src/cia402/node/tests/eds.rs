//! `drivers/strainwave.eds` and the SDO server describe the same objects.

use super::sdo::{read, write};
use super::*;
use std::collections::{BTreeMap, BTreeSet};
use std::string::ToString;

const EDS: &str = include_str!("../../../../strainwave.eds");

/// Their defaults are the joint's: identity, statusword, values, rated torque.
const WITHOUT_DEFAULT: [(u16, u8); 8] =
    [(0x1018, 2), (0x1018, 3), (0x1018, 4), (0x6041, 0), (0x6064, 0), (0x606c, 0), (0x6076, 0), (0x6077, 0)];

const READ_ONLY: u32 = 0x0601_0002;

type Section = BTreeMap<&'static str, &'static str>;

/// Keys and values by section.
fn sections() -> BTreeMap<&'static str, Section> {
    let mut sections = BTreeMap::<_, Section>::new();
    let mut name = "";
    for line in EDS.lines().filter(|line| !line.is_empty()) {
        if let Some(section) = line.strip_prefix('[') {
            name = section.strip_suffix(']').unwrap();
            assert_eq!(sections.insert(name, Section::new()), None, "{name}");
        } else {
            let (key, value) = line.split_once('=').unwrap();
            assert_eq!(sections.get_mut(name).unwrap().insert(key, value), None, "{name} {key}");
        }
    }
    sections
}

/// A number, decimal or by 0x, that may add the node.
fn number(text: &str) -> i64 {
    if let Some(rest) = text.strip_prefix("$NODEID+") {
        return i64::from(NODE) + number(rest);
    }
    match text.strip_prefix("0x") {
        Some(digits) => i64::from_str_radix(digits, 16).unwrap(),
        None => text.parse().unwrap(),
    }
}

const NODE: u8 = 1;

/// A node as it starts.
fn node() -> Node {
    Params { node: NODE, ..PARAMS }.build().unwrap()
}

/// Size in bytes of a data type, and whether it has a sign.
fn data_type(code: i64) -> (u8, bool) {
    match code {
        0x02 => (1, true),
        0x03 => (2, true),
        0x04 => (4, true),
        0x05 => (1, false),
        0x06 => (2, false),
        0x07 => (4, false),
        _ => panic!("{code:#x}"),
    }
}

/// All objects that are described, by index and subindex.
fn described() -> BTreeMap<(u16, u8), Section> {
    let hex = |digits| u16::from_str_radix(digits, 16).ok();
    let sections = sections();
    let mut objects = BTreeMap::new();
    for (name, section) in &sections {
        let (index, subindex) = name.split_once("sub").unwrap_or((name, "0"));
        let Some(index) = hex(index) else { continue };
        match section["ObjectType"] {
            "0x7" => _ = objects.insert((index, hex(subindex).unwrap() as u8), section.clone()),
            "0x8" | "0x9" => {
                let subindices = sections.keys().filter(|key| key.starts_with(&std::format!("{name}sub")));
                assert_eq!(number(section["SubNumber"]), subindices.count() as i64, "{name}");
            }
            other => panic!("{name} {other}"),
        }
    }
    objects
}

#[test]
fn every_object_is_described_and_no_other() {
    let mut node = node();
    let mut present = BTreeSet::new();
    for index in 0..=u16::MAX {
        if read(&mut node, index, 0) != Err(0x0602_0000) {
            present.extend(
                (0..=255).map(|sub| (index, sub)).filter(|&(_, sub)| read(&mut node, index, sub).is_ok()),
            );
        }
    }
    assert_eq!(described().into_keys().collect::<BTreeSet<_>>(), present);
}

#[test]
fn lists_of_objects_are_complete() {
    let sections = sections();
    let mut listed = BTreeSet::new();
    for list in ["MandatoryObjects", "OptionalObjects", "ManufacturerObjects"] {
        let list = &sections[list];
        let count = number(list["SupportedObjects"]);
        assert_eq!(list.len() as i64, count + 1);
        for place in 1..=count {
            assert!(listed.insert(number(list[&place.to_string()[..]]) as u16));
        }
    }
    assert_eq!(listed, described().into_keys().map(|(index, _)| index).collect());
}

#[test]
fn sizes_and_defaults_are_those_of_the_node() {
    let mut node = node();
    let mut without = Vec::new();
    for (object, section) in described() {
        let (size, value) = read(&mut node, object.0, object.1).unwrap();
        let (bytes, signed) = data_type(number(section["DataType"]));
        assert_eq!(bytes, size, "{object:x?}");
        let unused = 32 - 8 * u32::from(size);
        let value = if signed { i64::from((value << unused) as i32 >> unused) } else { value.into() };
        match section.get("DefaultValue") {
            Some(default) => assert_eq!(number(default), value, "{object:x?}"),
            None => without.push(object),
        }
    }
    assert_eq!(without, WITHOUT_DEFAULT);
}

#[test]
fn access_is_that_of_the_node() {
    let mut node = node();
    for (object, section) in described() {
        let (size, value) = read(&mut node, object.0, object.1).unwrap();
        let written = write(&mut node, object.0, object.1, size, value);
        match section["AccessType"] {
            // No mode is a value that only the start has.
            "rw" if object == (0x6060, 0) => assert_eq!(write(&mut node, 0x6060, 0, 1, 8), Ok(())),
            "rw" => assert_eq!(written, Ok(()), "{object:x?}"),
            "ro" | "const" => assert_eq!(written, Err(READ_ONLY), "{object:x?}"),
            other => panic!("{object:x?} {other}"),
        }
    }
}

#[test]
fn constants_stay_and_other_objects_change() {
    let (mut first, mut later) = (node(), node());
    later.read(&MOVES, true);
    later.receive(&frame(0x000, &[1, NODE]));
    later.receive(&frame(0x201, &[0x06, 0, 10, 1, 0, 0, 0]));
    later.receive(&frame(0x301, &[1, 0, 0, 0, 1, 0]));
    later.receive(&sync());
    later.read(&Actual { fault: 0x4210, ..MOVES }, true);
    for (object, section) in described() {
        let values = [&mut first, &mut later].map(|node| read(node, object.0, object.1).unwrap());
        match section["AccessType"] {
            "const" => assert_eq!(values[0], values[1], "{object:x?}"),
            "ro" => assert_ne!(values[0], values[1], "{object:x?}"),
            _ => {}
        }
    }
}

#[test]
fn what_is_mapped_is_described_as_such() {
    let described = described();
    let mapped = |index: u16| matches!(index, 0x1600 | 0x1601 | 0x1a00 | 0x1a01);
    let entries = described.iter().filter(|(object, _)| mapped(object.0) && object.1 > 0);
    let mut expected = BTreeSet::new();
    for (_, entry) in entries {
        let entry = number(entry["DefaultValue"]);
        let object = ((entry >> 16) as u16, (entry >> 8) as u8);
        assert_eq!(8 * i64::from(data_type(number(described[&object]["DataType"])).0), entry & 0xff);
        expected.insert(object);
    }
    let told = described.into_iter().filter(|(_, section)| section["PDOMapping"] == "1");
    assert_eq!(told.map(|(object, _)| object).collect::<BTreeSet<_>>(), expected);
}
