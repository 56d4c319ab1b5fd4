//! Generated road networks, written as OpenDRIVE.
