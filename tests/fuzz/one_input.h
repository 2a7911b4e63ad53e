#pragma once
#include <cstddef>
#include <cstdint>

namespace supple::fuzz {

/// Gives the bytes to every reader of meshes and surfaces, whatever they look like. Only supple::Error may leave a reader, and what it
/// accepts must be consistent. Aborts otherwise. Returns how many readers accepted them.
int read_as_everything(const std::uint8_t* data, std::size_t size);

}  // namespace supple::fuzz
