//! defmt over UART 0, from thread mode only: see [`strainwave_app::logger`].

strainwave_app::global_logger!(super::uart::send);
