// What bad input must lead to: an error for people, nothing else.
#pragma once

#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>
#include <string>

#include "common/error.h"

namespace mocaplm {

// The message of the error of type `Expected` that `act` throws; fails the test when there is none.
template <class Expected = DataError, class Act>
std::string refusal(const Act& act) {
  try {
    act();
  } catch (const Expected& error) {
    return error.what();
  } catch (const std::exception& error) {
    ADD_FAILURE() << "another kind of error: " << error.what();
    return "";
  }
  ADD_FAILURE() << "expected an error";
  return "";
}

// Calls `read`; it must either succeed or throw DataError whose text holds `name`. Returns success.
template <class Read>
bool reads_or_refuses(const Read& read, const std::string& name) {
  try {
    read();
    return true;
  } catch (const DataError& error) {
    EXPECT_NE(std::string(error.what()).find(name), std::string::npos) << error.what();
    return false;
  }
}

inline bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

inline std::size_t count(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1))
    ++found;
  return found;
}

// Plain and quick: no care for what was there (ext4 waits for the disk when a file is overwritten).
inline void put(const std::string& path, const std::string& bytes) {
  std::remove(path.c_str());
  std::ofstream(path, std::ios::binary | std::ios::trunc) << bytes;
}

}  // namespace mocaplm
