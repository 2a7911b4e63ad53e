#include "supple/io/binary_file.h"

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <memory>
#include <random>
#include <system_error>

#include "supple/base/error.h"

namespace supple::io {

namespace {

namespace fs = std::filesystem;

struct CloseFile {
    void operator()(std::FILE* f) const { std::fclose(f); }
};
using File = std::unique_ptr<std::FILE, CloseFile>;

[[noreturn]] void fail(const fs::path& file, const std::string& action, int system_error) {
    std::string reason = system_error ? std::generic_category().message(system_error) : "input/output error";
    throw Error(ErrorCode::file_unreadable, file.string(), action + ": " + reason);
}

template <class Buffer>
Buffer read_file(const fs::path& file) {
    std::error_code ignored;
    if (fs::is_directory(file, ignored)) throw Error(ErrorCode::file_unreadable, file.string(), "this is a directory; give a file");
    errno = 0;
    const File f(std::fopen(file.c_str(), "rb"));
    if (!f) fail(file, "cannot open the file for reading", errno);
    Buffer buffer;
    // Not by the file's size alone: pipes have none, and a file may grow or shrink meanwhile.
    const std::uintmax_t expected = fs::is_regular_file(file, ignored) ? fs::file_size(file, ignored) : 0;
    std::size_t used = 0;
    buffer.resize(ignored ? 65536 : std::size_t(expected) + 1);
    for (;;) {
        used += std::fread(reinterpret_cast<char*>(buffer.data()) + used, 1, buffer.size() - used, f.get());
        if (used < buffer.size()) break;
        buffer.resize(2 * buffer.size());
    }
    if (std::ferror(f.get())) fail(file, "cannot read the file", errno);
    buffer.resize(used);
    return buffer;
}

void write_all(const fs::path& target, const fs::path& named, std::span<const std::byte> bytes) {
    errno = 0;
    File f(std::fopen(target.c_str(), "wb"));
    if (!f) fail(named, "cannot open the file for writing", errno);
    const bool written =
        (bytes.empty() || std::fwrite(bytes.data(), 1, bytes.size(), f.get()) == bytes.size()) && std::fflush(f.get()) == 0;
    const int write_error = errno;
    const bool closed = std::fclose(f.release()) == 0;
    if (!written || !closed) fail(named, "cannot write the file", written ? errno : write_error);
}

/// A name next to the target that no other writer uses, in this process or another.
fs::path temporary_name(const fs::path& target) {
    static std::atomic<unsigned> counter{0};
    std::random_device random;
    fs::path name = target;
    name += ".partial-" + std::to_string(random()) + "-" + std::to_string(counter++);
    return name;
}

}  // namespace

std::vector<std::byte> read_binary_file(const fs::path& file) { return read_file<std::vector<std::byte>>(file); }

std::string read_text_file(const fs::path& file) { return read_file<std::string>(file); }

void write_binary_file(const fs::path& file, std::span<const std::byte> bytes) {
    std::error_code ignored;
    const fs::file_status status = fs::status(file, ignored);
    if (fs::is_directory(status)) throw Error(ErrorCode::file_unreadable, file.string(), "this is a directory; give a file name");
    if (fs::exists(status) && !fs::is_regular_file(status)) return write_all(file, file, bytes);
    // Writing through a link changes the file it points to, not the link.
    const fs::path target = fs::is_symlink(fs::symlink_status(file, ignored)) ? fs::weakly_canonical(file, ignored) : file;
    const fs::path temporary = temporary_name(target.empty() ? file : target);
    try {
        write_all(temporary, file, bytes);
    } catch (...) {
        fs::remove(temporary, ignored);
        throw;
    }
    std::error_code failed;
    fs::rename(temporary, target.empty() ? file : target, failed);
    if (failed) {
        fs::remove(temporary, ignored);
        fail(file, "cannot rename the finished file into place", failed.value());
    }
}

void write_text_file(const fs::path& file, std::string_view text) {
    write_binary_file(file, std::as_bytes(std::span<const char>(text.data(), text.size())));
}

}  // namespace supple::io
