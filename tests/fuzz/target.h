#pragma once

#include <cstddef>
#include <cstdint>

/// What libFuzzer and replay.cc call: runs one input. Whatever must never happen aborts.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);
