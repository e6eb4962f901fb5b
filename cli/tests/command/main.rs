//! The built command, run in a folder of its own.

mod bad_input;
mod belt;
mod bench;
mod connect;
mod connect_emulated;
mod design;
mod documentation;
mod example_logs;
mod experiment;
mod export;
mod flash;
mod follower;
mod good_input;
mod identification_page;
mod identify;
mod keep;
mod link;
mod missed;
mod operator;
mod own_joint;
mod robot;
mod sensors;
mod served;
mod set_up;
mod trajectory;
