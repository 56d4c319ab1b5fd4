//! Tests of `render`, one program for all its modules.

mod cpu;
