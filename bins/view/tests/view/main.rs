//! The program from outside: what it serves, what it refuses, what it writes.

mod bundle;
mod rules;
mod serve;
