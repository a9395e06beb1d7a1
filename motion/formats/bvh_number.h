// Numbers of a text, as fast as it can be read and yet to the last bit.
#pragma once

namespace mocaplm {

// Reads a decimal number ("-12.5", "+3", ".04", "1.5e-07") at `from`, which ends before `to`, and
// returns the place behind it, or `from` where no number stands. The double is the nearest to what
// is written, as std::from_chars gives it. What is too small to be told from zero is 0, what is too
// large is infinite; "inf" and "nan" are read as such, too.
const char* parse_number(const char* from, const char* to, double& value);

}  // namespace mocaplm
