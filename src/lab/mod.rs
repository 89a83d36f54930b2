//! Simulated people who play the devices, and scores of what came out.
