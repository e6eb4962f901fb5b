//! defmt over USART1, from thread mode only: see [`strainwave_app::logger`].

strainwave_app::global_logger!(crate::serial::send);
