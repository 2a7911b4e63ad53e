#pragma once
#include <functional>
#include <string_view>

namespace supple {

enum class LogLevel { info, warning, error };

/// Receives every message of one World or reader. The library never prints; without a sink messages are dropped.
/// Called only outside step(), on the thread that made the call.
using LogSink = std::function<void(LogLevel, std::string_view message)>;

}  // namespace supple
