//! The plugin interface of `qemu-plugin.h`, and the plugin's entry points.

use std::cell::UnsafeCell;
use std::ffi::{CStr, c_char, c_int, c_uint, c_void};
use std::fmt::Write as _;
use std::path::PathBuf;

use crate::counter::{Counter, Kept, Spread};
use crate::plan::{Instruction, Plan};

/// The interface version that the plugin declares.
#[unsafe(no_mangle)]
pub static qemu_plugin_version: c_int = api_version(option_env!("STRAINWAVE_QEMU_PLUGIN_API"));

const fn api_version(from_host: Option<&str>) -> c_int {
    match from_host {
        None => 1,
        Some(text) => match c_int::from_str_radix(text, 10) {
            Ok(version) => version,
            Err(_) => panic!("STRAINWAVE_QEMU_PLUGIN_API must be a number"),
        },
    }
}

/// `qemu_info_t`: the part of it that every version has.
#[repr(C)]
pub struct Info {
    target_name: *const c_char,
    version_min: c_int,
    version_current: c_int,
    system_emulation: bool,
    cpus: c_int,
    cpus_max: c_int,
}

type Id = u64;
#[repr(C)]
struct Block([u8; 0]);
#[repr(C)]
struct BlockInstruction([u8; 0]);

/// `QEMU_PLUGIN_CB_NO_REGS`: the callback reads no register of the guest.
const NO_REGISTERS: c_int = 0;

unsafe extern "C" {
    fn qemu_plugin_register_vcpu_tb_trans_cb(id: Id, callback: extern "C" fn(Id, *mut Block));
    fn qemu_plugin_register_vcpu_insn_exec_cb(
        instruction: *mut BlockInstruction,
        callback: extern "C" fn(c_uint, *mut c_void),
        flags: c_int,
        data: *mut c_void,
    );
    fn qemu_plugin_register_atexit_cb(id: Id, callback: extern "C" fn(Id, *mut c_void), data: *mut c_void);
    fn qemu_plugin_tb_n_insns(block: *const Block) -> usize;
    fn qemu_plugin_tb_get_insn(block: *const Block, index: usize) -> *mut BlockInstruction;
    fn qemu_plugin_insn_vaddr(instruction: *const BlockInstruction) -> u64;
}

struct Run {
    plan: &'static Plan,
    counter: Counter<'static>,
    out: PathBuf,
}

struct Slot(UnsafeCell<Option<Run>>);

// SAFETY: QEMU calls the plugin from the thread that loads it, and then, `install` having refused more
// than one CPU, from the one thread that emulates it; the callback at exit runs when that thread has stopped
// or is itself the one that exits.
unsafe impl Sync for Slot {}

static RUN: Slot = Slot(UnsafeCell::new(None));

/// QEMU's call when it has loaded the plugin; not 0 makes QEMU refuse to start.
///
/// # Safety
/// `info` points to QEMU's `qemu_info_t` and `arguments` to `count` C strings.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn qemu_plugin_install(
    id: Id,
    info: *const Info,
    count: c_int,
    arguments: *const *const c_char,
) -> c_int {
    // SAFETY: QEMU passes a valid `qemu_info_t` that lives for the call.
    let info = unsafe { &*info };
    let texts = (0..usize::try_from(count).unwrap_or(0)).map(|k| {
        // SAFETY: QEMU passes `count` pointers to strings that end with 0.
        let text = unsafe { CStr::from_ptr(*arguments.add(k)) };
        text.to_string_lossy().into_owned()
    });
    match open(info, texts) {
        Ok(run) => {
            start(id, run);
            0
        }
        Err(message) => {
            eprintln!("counting plugin: {message}");
            1
        }
    }
}

fn open(info: &Info, arguments: impl Iterator<Item = String>) -> Result<Run, String> {
    if !info.system_emulation || info.cpus != 1 {
        return Err(format!("{} CPUs, allowed: a machine with 1", info.cpus));
    }
    let (mut plan, mut out, mut kept) = (None, None, Kept::default());
    for argument in arguments {
        match argument.split_once('=') {
            Some(("plan", file)) => plan = Some(file.to_owned()),
            Some(("out", folder)) => out = Some(PathBuf::from(folder)),
            Some(("calls", "yes")) => kept.calls = true,
            Some(("path", call)) if call.parse::<u64>().is_ok() => kept.path = call.parse().ok(),
            _ => {
                let allowed = "plan=FILE, out=FOLDER, calls=yes, path=NUMBER";
                return Err(format!("argument \"{argument}\", allowed: {allowed}"));
            }
        }
    }
    let file = plan.ok_or("argument plan=FILE is missing")?;
    let text = std::fs::read_to_string(&file).map_err(|error| format!("{file}: {error}"))?;
    // The instructions' addresses are handed to QEMU as callback data: the plan lives as long as QEMU.
    let plan: &'static Plan = Box::leak(Box::new(Plan::parse(&text)?));
    // Several emulators may run with the same arguments: each has a result of its own.
    let out = out.ok_or("argument out=FOLDER is missing")?.join(std::process::id().to_string());
    Ok(Run { plan, counter: Counter::new(plan, kept), out })
}

fn start(id: Id, run: Run) {
    // SAFETY: called once, from the thread that loads the plugin, before any callback is registered.
    unsafe { *RUN.0.get() = Some(run) };
    // SAFETY: `id` is what QEMU gave, and the callbacks have the types that qemu-plugin.h asks for.
    unsafe {
        qemu_plugin_register_vcpu_tb_trans_cb(id, translated);
        qemu_plugin_register_atexit_cb(id, exited, std::ptr::null_mut());
    }
}

fn with_run(act: impl FnOnce(&mut Run)) {
    // SAFETY: one thread at a time (see `Slot`), and no callback calls another.
    if let Some(run) = unsafe { (*RUN.0.get()).as_mut() } {
        act(run);
    }
}

/// QEMU has translated a block: every instruction of it reports when it is executed.
extern "C" fn translated(_: Id, block: *mut Block) {
    with_run(|run| {
        // SAFETY: `block` and the instructions in it are valid during this callback.
        unsafe {
            for index in 0..qemu_plugin_tb_n_insns(block) {
                instrument(qemu_plugin_tb_get_insn(block, index), run.plan);
            }
        }
    });
}

/// # Safety
/// `instruction` is one of the block that is being translated.
unsafe fn instrument(instruction: *mut BlockInstruction, plan: &'static Plan) {
    // SAFETY: the caller's promise; `data` is a reference that lives as long as QEMU, or an address that
    // is never dereferenced.
    unsafe {
        let address = qemu_plugin_insn_vaddr(instruction) as u32;
        match plan.instructions.get(&address) {
            Some(planned) => {
                let data = std::ptr::from_ref(planned).cast_mut().cast();
                qemu_plugin_register_vcpu_insn_exec_cb(instruction, executed, NO_REGISTERS, data);
            }
            None => {
                let data = std::ptr::without_provenance_mut(address as usize);
                qemu_plugin_register_vcpu_insn_exec_cb(instruction, unplanned, NO_REGISTERS, data);
            }
        }
    }
}

extern "C" fn executed(_: c_uint, data: *mut c_void) {
    // SAFETY: `data` is the reference into the leaked plan that `instrument` registered.
    let instruction: &'static Instruction = unsafe { &*data.cast::<Instruction>().cast_const() };
    with_run(|run| run.counter.execute(instruction));
}

extern "C" fn unplanned(_: c_uint, data: *mut c_void) {
    with_run(|run| run.counter.unplanned(data.addr() as u32));
}

extern "C" fn exited(_: Id, _: *mut c_void) {
    with_run(|run| {
        if let Err(error) = std::fs::write(&run.out, report(&run.counter)) {
            eprintln!("counting plugin: {}: {error}", run.out.display());
        }
    });
}

fn report(counter: &Counter) -> String {
    let mut text = String::new();
    let spread = |s: Spread| format!("{} {} {}", s.min, s.max, s.sum);
    for counts in counter.counts() {
        let (instructions, cycles) = (spread(counts.instructions), spread(counts.cycles));
        let _ = writeln!(text, "{} {instructions} {cycles}", counts.calls);
    }
    let _ = writeln!(text, "executed {}", counter.executed());
    for (name, words) in [("calls", numbers(counter.calls())), ("path", numbers(counter.path()))] {
        if let Some(words) = words {
            let _ = writeln!(text, "{name} {words}");
        }
    }
    if let Some(anomaly) = counter.anomaly() {
        let _ = writeln!(text, "anomaly {anomaly}");
    }
    text
}

/// The numbers as words; `None` of nothing.
fn numbers<T: ToString>(numbers: &[T]) -> Option<String> {
    let words: Vec<_> = numbers.iter().map(ToString::to_string).collect();
    (!words.is_empty()).then(|| words.join(" "))
}
