//! Rays and answers in files.
