//! The chips that are emulated, each with its board.

use std::ops::Range;

/// A chip on its board.
#[derive(Debug)]
pub struct Model {
    /// The board.
    pub board: &'static str,
    /// The chip and what is wired to it.
    pub description: &'static str,
    /// Its USART of telemetry and keys, as the description names it.
    pub serial: &'static str,
    /// Begin and size of the flash.
    pub flash: (u32, usize),
    /// Begin and size of the store of the tuning link, where there is one.
    pub store: Option<(u32, usize)>,
    /// Writing it does not hold the control up.
    pub writes_beside: bool,
    /// Its board can be flashed as a node on CAN.
    pub has_can: bool,
    /// Begin and size of the memory that the stack has to itself.
    pub stack: (u64, u64),
    /// The control's timer.
    pub timer: Timer,
    /// Address of the register of the torque's code of 12 bits, and the lowest of these bits.
    pub torque: (u64, u32),
    /// Address of the output data of the port of the drive's enable, and the enable in it.
    pub enable: (u64, u32),
}

impl Model {
    /// Addresses of the memory that the stack has to itself.
    pub fn stack(&self) -> Range<u64> {
        let (begin, size) = self.stack;
        begin..begin + size
    }
}

/// The control's timer.
#[derive(Clone, Copy, Debug)]
pub enum Timer {
    /// TIM2 of an STM32.
    Tim2,
    /// The core's.
    SysTick,
}

/// All of them.
pub static MODELS: [Model; 4] = [
    Model {
        board: "stm32f405",
        description: include_str!("stm32/stm32f405.machine"),
        serial: "usart1",
        flash: (0x0800_0000, 1 << 20),
        store: Some((0x0800_4000, 32 << 10)),
        writes_beside: false,
        has_can: false,
        stack: (0x1000_0000, 64 << 10),
        timer: Timer::Tim2,
        torque: (0x4000_7408, 0),
        enable: (0x4002_0414, 1 << 0),
    },
    Model {
        board: "nucleo-g474re",
        description: include_str!("stm32/nucleo-g474re.machine"),
        serial: "usart2",
        flash: (0x0800_0000, 512 << 10),
        store: Some((0x0807_f000, 4 << 10)),
        writes_beside: true,
        has_can: true,
        stack: (0x1000_0000, 32 << 10),
        timer: Timer::Tim2,
        torque: (0x5000_0808, 0),
        enable: (0x4800_0414, 1 << 0),
    },
    Model {
        board: "nucleo-h743zi",
        description: include_str!("stm32/nucleo-h743zi.machine"),
        serial: "usart3",
        flash: (0x0800_0000, 2 << 20),
        store: Some((0x081c_0000, 256 << 10)),
        writes_beside: true,
        has_can: false,
        stack: (0x2000_0000, 16 << 10),
        timer: Timer::Tim2,
        torque: (0x4000_7408, 0),
        enable: (0x5802_0414, 1 << 1),
    },
    Model {
        board: "pico2",
        description: include_str!("rp2350/pico2.machine"),
        serial: "uart0",
        flash: (0x1000_0000, 4 << 20),
        store: None,
        writes_beside: true,
        has_can: false,
        stack: (0x2000_0000, 16 << 10),
        timer: Timer::SysTick,
        torque: (0x400a_8098, 16),
        enable: (0xd000_0010, 1 << 14),
    },
];
