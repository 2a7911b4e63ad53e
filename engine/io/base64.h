#pragma once
#include <string>
#include <string_view>

namespace supple::io {

/// Base64 with padding (RFC 4648).
std::string to_base64(std::string_view bytes);

}  // namespace supple::io
