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
    /// Size of the flash.
    pub flash_bytes: usize,
    /// Begin and size of the memory that the stack has to itself.
    pub stack: (u64, u64),
    /// Address of the DAC's data, 12 bits.
    pub torque: u64,
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

/// All of them.
pub static MODELS: [Model; 3] = [
    Model {
        board: "stm32f405",
        description: include_str!("stm32f405.machine"),
        serial: "usart1",
        flash_bytes: 1 << 20,
        stack: (0x1000_0000, 64 << 10),
        torque: 0x4000_7408,
        enable: (0x4002_0414, 1 << 0),
    },
    Model {
        board: "nucleo-g474re",
        description: include_str!("nucleo-g474re.machine"),
        serial: "usart2",
        flash_bytes: 512 << 10,
        stack: (0x1000_0000, 32 << 10),
        torque: 0x5000_0808,
        enable: (0x4800_0414, 1 << 0),
    },
    Model {
        board: "nucleo-h743zi",
        description: include_str!("nucleo-h743zi.machine"),
        serial: "usart3",
        flash_bytes: 2 << 20,
        stack: (0x2000_0000, 16 << 10),
        torque: 0x4000_7408,
        enable: (0x5802_0414, 1 << 1),
    },
];
