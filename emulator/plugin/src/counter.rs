//! Follows the executed instructions and sums them up per call of a tracked function.
//!
//! A call of a tracked function begins with its first instruction and ends with the instruction that
//! returns from it; everything that it calls is counted in. What an exception handler executes is not
//! part of the interrupted call: the running totals go back to where they were when it returns.
//!
//! Calls, returns and exceptions are followed on a shadow of the stack, so that tail calls, nested tracked
//! functions and functions that are reached from several places all end where they really end. Where
//! control goes is settled only when the next instruction is known, and after an exception only when the
//! handler has come back: an interrupt between a branch and its target then changes no count.

use crate::plan::{Flow, Instruction, Plan};

/// Smallest, largest and sum over the calls.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Spread {
    /// Smallest of a call.
    pub min: u64,
    /// Largest of a call.
    pub max: u64,
    /// Sum over all calls.
    pub sum: u64,
}

impl Spread {
    const NONE: Self = Self { min: u64::MAX, max: 0, sum: 0 };

    fn add(&mut self, value: u64) {
        self.min = self.min.min(value);
        self.max = self.max.max(value);
        self.sum += value;
    }
}

/// Counts of one tracked function.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Counts {
    /// Calls that have returned.
    pub calls: u64,
    /// Instructions per call.
    pub instructions: Spread,
    /// Cycles per call.
    pub cycles: Spread,
}

/// Records of the first tracked function in addition to its counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Kept {
    /// The cycles of every call.
    pub calls: bool,
    /// The instructions of the call of this number, the first call's being 0.
    pub path: Option<u64>,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Totals {
    instructions: u64,
    cycles: u64,
}

enum Frame<'p> {
    /// A call; where it comes back to.
    Call(u32),
    /// An exception; the instruction that it came after, and the totals at that time.
    Exception(Option<&'p Instruction>, Totals),
}

struct Activation {
    tracked: usize,
    depth: usize,
    since: Totals,
}

/// Calls nest no deeper than this in any firmware whose stack is bounded.
const DEPTH_MAX: usize = 1024;

/// Counts while the guest runs.
pub struct Counter<'p> {
    plan: &'p Plan,
    previous: Option<&'p Instruction>,
    frames: Vec<Frame<'p>>,
    activations: Vec<Activation>,
    totals: Totals,
    executed: u64,
    counts: Vec<Counts>,
    kept: Kept,
    calls: Vec<u64>,
    path: Vec<u32>,
    anomaly: Option<String>,
}

impl<'p> Counter<'p> {
    /// Nothing executed yet.
    pub fn new(plan: &'p Plan, kept: Kept) -> Self {
        let none = Counts { calls: 0, instructions: Spread::NONE, cycles: Spread::NONE };
        Self {
            plan,
            previous: None,
            frames: Vec::with_capacity(DEPTH_MAX),
            activations: Vec::with_capacity(plan.tracked.len()),
            totals: Totals::default(),
            executed: 0,
            counts: vec![none; plan.tracked.len()],
            kept,
            calls: Vec::new(),
            path: Vec::new(),
            anomaly: None,
        }
    }

    /// One instruction is about to be executed.
    pub fn execute(&mut self, now: &'p Instruction) {
        let straight = self.previous.is_some_and(|p| p.flow == Flow::Straight && p.next == now.address);
        if !straight {
            self.transfer(now);
        }
        if let Some(tracked) = now.entry {
            self.enter(tracked);
        }
        if self.kept.path.is_some() && self.is_on_path() {
            self.path.push(now.address);
        }
        self.executed += 1;
        self.totals.instructions += 1;
        match now.cycles {
            Some(cycles) => self.totals.cycles += u64::from(cycles),
            None => self.not_costed(now.address),
        }
        self.previous = Some(now);
    }

    /// An instruction that the plan does not hold is about to be executed.
    pub fn unplanned(&mut self, address: u32) {
        self.executed += 1;
        self.totals.instructions += 1;
        self.not_costed(address);
        self.previous = None;
    }

    /// Every instruction executed, handlers included.
    pub fn executed(&self) -> u64 {
        self.executed
    }

    /// The counts, in the plan's order.
    pub fn counts(&self) -> &[Counts] {
        &self.counts
    }

    /// Cycles of every call of the first tracked function, where they are kept.
    pub fn calls(&self) -> &[u64] {
        &self.calls
    }

    /// Addresses of the instructions of one call of the first tracked function, where they are kept.
    pub fn path(&self) -> &[u32] {
        &self.path
    }

    /// The first thing seen inside a tracked call that makes its counts wrong.
    pub fn anomaly(&self) -> Option<&str> {
        self.anomaly.as_deref()
    }

    /// The call of the first tracked function whose instructions are kept is running.
    fn is_on_path(&self) -> bool {
        let calls = self.counts.first().map(|counts| counts.calls);
        calls == self.kept.path && self.activations.iter().any(|activation| activation.tracked == 0)
    }

    fn not_costed(&mut self, address: u32) {
        self.report(|| format!("uncosted {address:#x}"));
    }

    /// Outside of a tracked call nothing can be counted wrongly.
    fn report(&mut self, what: impl FnOnce() -> String) {
        if self.anomaly.is_none() && !self.activations.is_empty() {
            self.anomaly = Some(what());
        }
    }

    /// Control did not, or might not, go straight on to `now`.
    fn transfer(&mut self, now: &'p Instruction) {
        if now.reset {
            self.restart();
        } else if now.handler && self.previous.is_none_or(|p| p.next != now.address) {
            self.frames.push(Frame::Exception(self.previous, self.totals));
        } else if let Some(previous) = self.previous {
            self.settle(previous, now);
        }
        if self.frames.len() > DEPTH_MAX {
            self.report(|| format!("depth {:#x}", now.address));
            self.restart();
        }
    }

    fn restart(&mut self) {
        self.frames.clear();
        self.activations.clear();
        self.path.clear();
    }

    fn settle(&mut self, previous: &'p Instruction, now: &'p Instruction) {
        let taken = !previous.conditional || now.address != previous.next;
        if taken && previous.conditional {
            self.totals.cycles += u64::from(self.plan.refill);
        }
        match previous.flow {
            Flow::Call if taken => self.frames.push(Frame::Call(previous.next)),
            Flow::Return if taken => self.come_back(now),
            Flow::Straight if now.address != previous.next => {
                self.report(|| format!("jump {:#x} {:#x}", previous.address, now.address));
            }
            _ => {}
        }
    }

    fn come_back(&mut self, now: &'p Instruction) {
        let frame = self.frames.pop();
        self.leave();
        match frame {
            Some(Frame::Exception(interrupted, totals)) => {
                self.totals = totals;
                self.previous = interrupted;
                self.transfer(now);
            }
            Some(Frame::Call(back)) if back != now.address => {
                self.report(|| format!("return {back:#x} {:#x}", now.address));
            }
            _ => {}
        }
    }

    /// Ends the activations whose frame is gone.
    fn leave(&mut self) {
        let depth = self.frames.len();
        while let Some(activation) = self.activations.pop_if(|a| a.depth > depth) {
            let counts = &mut self.counts[activation.tracked];
            counts.calls += 1;
            counts.instructions.add(self.totals.instructions - activation.since.instructions);
            let cycles = self.totals.cycles - activation.since.cycles;
            counts.cycles.add(cycles);
            if self.kept.calls && activation.tracked == 0 {
                self.calls.push(cycles);
            }
        }
    }

    /// A loop back to the first instruction is no new call.
    fn enter(&mut self, tracked: usize) {
        let function = self.plan.tracked[tracked];
        let inside = |p: &Instruction| p.address.wrapping_sub(function.start) < function.size;
        if self.previous.is_some_and(|p| p.flow != Flow::Call && inside(p)) {
            return;
        }
        self.activations.push(Activation { tracked, depth: self.frames.len(), since: self.totals });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Runs the addresses and gives (calls, instructions, cycles) of every tracked function.
    fn run(plan: &str, addresses: &[u32]) -> (Vec<Counts>, Option<String>) {
        let plan = Plan::parse(plan).unwrap();
        let mut counter = Counter::new(&plan, Kept::default());
        for address in addresses {
            match plan.instructions.get(address) {
                Some(instruction) => counter.execute(instruction),
                None => counter.unplanned(*address),
            }
        }
        assert_eq!(counter.executed(), addresses.len() as u64);
        (counter.counts().to_vec(), counter.anomaly().map(str::to_owned))
    }

    fn of_one_call(counts: &Counts) -> (u64, u64) {
        assert_eq!((counts.calls, counts.instructions.min), (1, counts.instructions.max));
        (counts.instructions.sum, counts.cycles.sum)
    }

    /// main 0: bl 10; b 0. step 10: push; bl 20; pop pc. leaf 20: add; bx lr. handler 30: add; bx lr.
    const PROGRAM: &str = "refill 3\ntracked 10 6\ntracked 20 4\nhandler 30\n\
        insn 0 4 4 c\ninsn 4 2 4 b\n\
        insn 10 2 2 -\ninsn 12 4 4 c\ninsn 16 2 5 r\n\
        insn 20 2 1 -\ninsn 22 2 4 r\n\
        insn 30 2 1 -\ninsn 32 2 4 r";

    #[test]
    fn a_call_counts_its_callees_and_not_its_caller() {
        let (counts, anomaly) = run(PROGRAM, &[0, 0x10, 0x12, 0x20, 0x22, 0x16, 4, 0]);
        assert_eq!(of_one_call(&counts[0]), (5, 2 + 4 + 1 + 4 + 5));
        assert_eq!(of_one_call(&counts[1]), (2, 5));
        assert_eq!(anomaly, None);
    }

    #[test]
    fn a_call_that_has_not_returned_is_not_counted() {
        let (counts, _) = run(PROGRAM, &[0, 0x10, 0x12, 0x20, 0x22, 0x16]);
        assert_eq!((counts[0].calls, counts[1].calls), (0, 1));
    }

    #[test]
    fn an_exception_changes_no_count_wherever_it_strikes() {
        let program = [0, 0x10, 0x12, 0x20, 0x22, 0x16, 4, 0];
        let (undisturbed, _) = run(PROGRAM, &program);
        for at in 1..program.len() {
            let disturbed = [&program[..at], &[0x30, 0x32], &program[at..]].concat();
            assert_eq!(run(PROGRAM, &disturbed), (undisturbed.clone(), None), "before instruction {at}");
            let chained = [&program[..at], &[0x30, 0x32, 0x30, 0x32], &program[at..]].concat();
            assert_eq!(run(PROGRAM, &chained), (undisturbed.clone(), None), "tail-chained at {at}");
            let nested = [&program[..at], &[0x30, 0x30, 0x32, 0x32], &program[at..]].concat();
            assert_eq!(run(PROGRAM, &nested), (undisturbed.clone(), None), "nested at {at}");
        }
    }

    #[test]
    fn a_handler_is_counted_by_its_own_name() {
        let plan = PROGRAM.replace("tracked 20 4", "tracked 30 4");
        let (counts, anomaly) = run(&plan, &[0, 0x10, 0x30, 0x32, 0x12, 0x20, 0x22, 0x16, 4]);
        assert_eq!(of_one_call(&counts[0]), (5, 16));
        assert_eq!(of_one_call(&counts[1]), (2, 5));
        assert_eq!(anomaly, None);
    }

    #[test]
    fn a_tail_call_ends_with_its_caller() {
        let plan = PROGRAM.replace("insn 12 4 4 c", "insn 12 4 4 b");
        let (counts, anomaly) = run(&plan, &[0, 0x10, 0x12, 0x20, 0x22, 4, 0]);
        assert_eq!(of_one_call(&counts[0]), (4, 2 + 4 + 1 + 4));
        assert_eq!(of_one_call(&counts[1]), (2, 5));
        assert_eq!(anomaly, None);
    }

    #[test]
    fn a_taken_conditional_branch_refills_the_pipeline() {
        let plan = "refill 3\ntracked 10 8\ninsn 0 4 4 c\ninsn 4 2 4 b\n\
            insn 10 2 1 B\ninsn 12 2 1 -\ninsn 14 2 1 R\ninsn 16 2 4 r";
        let (counts, _) = run(plan, &[0, 0x10, 0x12, 0x14, 0x16, 4]);
        assert_eq!(of_one_call(&counts[0]), (4, 7));
        let (counts, _) = run(plan, &[0, 0x10, 0x14, 4]);
        assert_eq!(of_one_call(&counts[0]), (2, (1 + 3) + (1 + 3)));
    }

    #[test]
    fn a_loop_to_the_first_instruction_is_no_new_call() {
        let plan = "refill 3\ntracked 10 6\ninsn 0 4 4 c\ninsn 4 2 4 b\n\
            insn 10 2 1 -\ninsn 12 2 1 B\ninsn 14 2 4 r";
        let (counts, _) = run(plan, &[0, 0x10, 0x12, 0x10, 0x12, 0x14, 4]);
        assert_eq!(of_one_call(&counts[0]), (5, 1 + 4 + 1 + 1 + 4));
    }

    #[test]
    fn smallest_and_largest_call_are_kept_apart() {
        let plan = PROGRAM.replace("insn 12 4 4 c", "insn 12 4 1 C");
        let long = [0, 0x10, 0x12, 0x20, 0x22, 0x16, 4];
        let short = [0, 0x10, 0x12, 0x16, 4];
        let (counts, _) = run(&plan, &[&long[..], &short[..]].concat());
        assert_eq!(counts[0].calls, 2);
        assert_eq!(counts[0].instructions, Spread { min: 3, max: 5, sum: 8 });
        assert_eq!(counts[0].cycles, Spread { min: 8, max: 2 + 1 + 3 + 1 + 4 + 5, sum: 24 });
    }

    #[test]
    fn every_call_and_the_path_of_one_are_kept_where_they_are_asked_for() {
        let plan = Plan::parse(&PROGRAM.replace("insn 12 4 4 c", "insn 12 4 1 C")).unwrap();
        let mut counter = Counter::new(&plan, Kept { calls: true, path: Some(1) });
        let (long, short) = ([0, 0x10, 0x12, 0x20, 0x22, 0x16, 4], [0, 0x10, 0x12, 0x16, 4]);
        for address in long.iter().chain(&short).chain(&long) {
            counter.execute(&plan.instructions[address]);
        }
        assert_eq!(counter.calls(), [2 + 1 + 3 + 1 + 4 + 5, 8, 16]);
        assert_eq!(counter.path(), [0x10, 0x12, 0x16]);
    }

    #[test]
    fn a_reset_drops_what_was_running() {
        let plan = PROGRAM.replace("handler 30", "handler 30\nreset 0");
        let (counts, anomaly) = run(&plan, &[0, 0x10, 0x12, 0, 0x10, 0x12, 0x20, 0x22, 0x16, 4]);
        assert_eq!(of_one_call(&counts[0]), (5, 16));
        assert_eq!(anomaly, None);
    }

    #[test]
    fn what_would_make_a_count_wrong_is_named() {
        let unknown = PROGRAM.replace("insn 20 2 1 -", "insn 20 2 ? -");
        assert_eq!(run(&unknown, &[0, 0x10, 0x12, 0x20]).1.unwrap(), "uncosted 0x20");
        assert_eq!(run(PROGRAM, &[0, 0x10, 0x40]).1.unwrap(), "uncosted 0x40");
        assert_eq!(run(PROGRAM, &[0, 0x10, 0x20]).1.unwrap(), "jump 0x10 0x20");
        assert_eq!(run(PROGRAM, &[0, 0x10, 0x12, 0x20, 0x22, 0]).1.unwrap(), "return 0x16 0x0");
        assert_eq!(run(PROGRAM, &[0x40, 4, 0x20]).1, None);
    }
}
