//! What `simulate-and-log` counts.

/// Frames times agents. Rows carry the agent.
pub const AGENT_FRAMES: &str = "agent_frames";
