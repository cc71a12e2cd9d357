//! The language: texts that were misread, refused without need, or answered by messages of the compiler.
