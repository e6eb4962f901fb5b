//! A QEMU process that never outlives us.
//!
//! It is killed and waited for when its [`Process`] is dropped; on Ctrl-C and on SIGTERM, whose
//! [handler](crate::interrupt) ends every live one; and by the kernel when this process dies in any
//! other way, because it asked for that at its birth (`setpriv --pdeathsig`). The kernel's "parent" is
//! the thread that started the child, so all are started by one thread, which lives as long as this
//! process.

use std::ffi::OsStr;
use std::io;
use std::os::unix::process::CommandExt;
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::mpsc::{Sender, channel};
use std::sync::{Arc, LazyLock, Mutex, Once, Weak};
use std::time::{Duration, Instant};

use crate::interrupt;
use crate::lock::locked;
use crate::scratch::Scratch;

/// A running child, and the private directory that it works in.
pub struct Process {
    child: Mutex<Child>,
    directory: Scratch,
}

impl Process {
    /// Starts `program` in `directory`.
    pub fn start(program: &Path, arguments: &[String], directory: Scratch) -> io::Result<Arc<Self>> {
        static KILLED: Once = Once::new();
        // Asked for after the removal of its folder, and so done before it.
        KILLED.call_once(|| interrupt::clean_up_with(kill_all));
        let mut command = tied_to_us(program);
        command.args(arguments).current_dir(directory.path());
        let said = std::fs::File::create(directory.path().join("emulator.log"))?;
        command.stdin(Stdio::null()).stdout(said.try_clone()?).stderr(said);
        // A terminal's Ctrl-C is for us alone: a child that dies of it first would look like a failure.
        command.process_group(0);
        let child = spawn_from_keeper(command)?;
        let process = Arc::new(Self { child: Mutex::new(child), directory });
        let mut live = locked(&LIVE);
        live.retain(|other| other.strong_count() > 0);
        live.push(Arc::downgrade(&process));
        drop(live);
        Ok(process)
    }

    /// The directory that the child works in; gone with the process.
    pub fn directory(&self) -> &Path {
        self.directory.path()
    }

    /// The child's process id.
    pub fn id(&self) -> u32 {
        locked(&self.child).id()
    }

    /// Exit status of the child, if it has ended.
    pub fn ended(&self) -> Option<ExitStatus> {
        locked(&self.child).try_wait().ok().flatten()
    }

    /// Waits for the child to end by itself.
    pub fn wait(&self, patience: Duration) -> Option<ExitStatus> {
        let deadline = Instant::now() + patience;
        loop {
            match self.ended() {
                None if Instant::now() < deadline => std::thread::sleep(Duration::from_millis(2)),
                status => return status,
            }
        }
    }

    /// Console output of the child.
    pub fn said(&self) -> String {
        let bytes = std::fs::read(self.directory().join("emulator.log")).unwrap_or_default();
        String::from_utf8_lossy(&bytes).trim().to_owned()
    }

    fn kill(&self) {
        let mut child = locked(&self.child);
        // Fails only when the child has ended and was waited for already.
        let _ = child.kill();
        let _ = child.wait();
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        self.kill();
    }
}

static LIVE: Mutex<Vec<Weak<Process>>> = Mutex::new(Vec::new());

/// Kills every live process, for a program that ends here.
fn kill_all() {
    for process in locked(&LIVE).drain(..).filter_map(|process| process.upgrade()) {
        process.kill();
    }
}

/// `program`, which the kernel is to kill when its parent dies, where the system can do that.
pub fn tied_to_us(program: impl AsRef<OsStr>) -> Command {
    if *CAN_TIE {
        let mut command = Command::new(TIE);
        command.args(["--pdeathsig", "KILL", "--"]).arg(program);
        command
    } else {
        Command::new(program)
    }
}

/// Program that asks the kernel for that.
const TIE: &str = "setpriv";

/// Whether the system has it.
static CAN_TIE: LazyLock<bool> = LazyLock::new(|| {
    let asked = Command::new(TIE).arg("--version").stdin(Stdio::null()).stdout(Stdio::null()).status();
    asked.is_ok_and(|status| status.success())
});

type Order = (Command, Sender<io::Result<Child>>);

/// The thread that starts every child and never ends.
static KEEPER: LazyLock<Mutex<Sender<Order>>> = LazyLock::new(|| {
    let (orders, inbox) = channel::<Order>();
    std::thread::spawn(move || {
        for (mut command, answer) in inbox {
            // Whoever ordered it may have gone; then the child goes with the answer's channel.
            if let Err(lost) = answer.send(command.spawn())
                && let Ok(mut child) = lost.0
            {
                let _ = child.kill();
                let _ = child.wait();
            }
        }
    });
    Mutex::new(orders)
});

fn spawn_from_keeper(command: Command) -> io::Result<Child> {
    let (answer, answered) = channel();
    let gone = |_| io::Error::other("the thread that starts the emulator is gone");
    locked(&KEEPER).send((command, answer)).map_err(|_| gone(()))?;
    answered.recv().map_err(|_| gone(()))?
}
