//! `layouts/*.ron` as people write them → checked, in SI units; every error names file, line and column.
