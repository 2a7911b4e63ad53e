#include "supple/render/video.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <utility>
#include <vector>

#include "supple/base/error.h"

extern char** environ;

namespace supple {
namespace {

class FileDescriptor {
public:
    FileDescriptor() = default;
    explicit FileDescriptor(int fd) : fd_(fd) {}
    ~FileDescriptor() { reset(); }
    FileDescriptor(const FileDescriptor&) = delete;
    FileDescriptor& operator=(const FileDescriptor&) = delete;
    int get() const { return fd_; }
    void reset(int fd = -1) {
        if (fd_ >= 0) ::close(fd_);
        fd_ = fd;
    }

private:
    int fd_ = -1;
};

void require_legal(const VideoDef& def) {
    const auto size = [](int value, const char* name) {
        if (value < 2 || value > 16384 || value % 2)
            throw Error(ErrorCode::invalid_argument, std::string("VideoDef.") + name,
                        std::to_string(value) + " pixels; H.264 needs an even number in [2, 16384]");
    };
    size(def.width, "width");
    size(def.height, "height");
    if (def.path.empty()) throw Error(ErrorCode::invalid_argument, "VideoDef.path", "is empty; name the file to write, e.g. out.mp4");
    if (!(def.frames_per_s >= 1 && def.frames_per_s <= 1000))
        throw Error(ErrorCode::invalid_argument, "VideoDef.frames_per_s", to_text(def.frames_per_s) + " is outside [1, 1000]");
    if (def.quality < 0 || def.quality > 51)
        throw Error(ErrorCode::invalid_argument, "VideoDef.quality",
                    std::to_string(def.quality) + " is outside [0, 51]; 18 looks lossless, 28 is small");
}

std::vector<std::string> arguments(const VideoDef& def) {
    // A path that starts with a dash would be taken for an option; "file:" also stops ffmpeg from reading "http:" as a protocol.
    return {def.program, "-hide_banner", "-nostdin", "-loglevel", "error", "-y", "-f", "rawvideo", "-pix_fmt", "rgb24", "-s",
            std::to_string(def.width) + "x" + std::to_string(def.height), "-r", to_text(def.frames_per_s), "-i", "pipe:0", "-an",
            // The frames are sRGB with BT.709 primaries: say so, or players guess BT.601 and shift the colours of the stress map.
            "-vf", "scale=out_color_matrix=bt709:out_range=tv", "-colorspace", "bt709", "-color_primaries", "bt709", "-color_trc", "bt709",
            "-color_range", "tv", "-c:v", "libx264", "-preset", "medium", "-crf", std::to_string(def.quality), "-pix_fmt", "yuv420p",
            "-movflags", "+faststart", "file:" + def.path};
}

}  // namespace

struct VideoWriter::Process {
    VideoDef def;
    FileDescriptor input;   // our end of ffmpeg's standard input
    FileDescriptor errors;  // what ffmpeg says; a memory file, so that it can never block
    pid_t pid = -1;

    explicit Process(const VideoDef& d) : def(d) { start(); }
    ~Process() {
        input.reset();
        if (pid > 0) wait();
    }

    void start() {
        int ends[2];
        // A socket pair and not a pipe: send(MSG_NOSIGNAL) fails with EPIPE, where write() would kill the host with SIGPIPE.
        if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) fail(std::string("no socket pair: ") + std::strerror(errno));
        input.reset(ends[0]);
        FileDescriptor theirs(ends[1]);
        errors.reset(::memfd_create("ffmpeg-errors", MFD_CLOEXEC));
        if (errors.get() < 0) fail(std::string("no memory file: ") + std::strerror(errno));

        posix_spawn_file_actions_t actions;
        posix_spawn_file_actions_init(&actions);
        posix_spawn_file_actions_adddup2(&actions, theirs.get(), 0);
        posix_spawn_file_actions_addopen(&actions, 1, "/dev/null", O_WRONLY, 0);
        posix_spawn_file_actions_adddup2(&actions, errors.get(), 2);
        std::vector<std::string> words = arguments(def);
        std::vector<char*> argv;
        for (std::string& word : words) argv.push_back(word.data());
        argv.push_back(nullptr);
        const int status = ::posix_spawnp(&pid, def.program.c_str(), &actions, nullptr, argv.data(), environ);
        posix_spawn_file_actions_destroy(&actions);
        if (status != 0) {
            pid = -1;
            fail("'" + def.program + "' cannot be started (" + std::strerror(status) +
                 "): install it (Debian: apt-get install ffmpeg), or record PNG frames instead: --out DIR");
        }
    }

    [[noreturn]] void fail(const std::string& message) const { throw Error(ErrorCode::external_tool, def.path, message); }

    /// @return ffmpeg's exit status, or 128 + signal
    int wait() {
        int status = 0;
        while (::waitpid(pid, &status, 0) < 0)
            if (errno != EINTR) break;
        pid = -1;
        return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + (WIFSIGNALED(status) ? WTERMSIG(status) : 0);
    }

    std::string last_words() const {
        char text[1500] = {};
        const off_t end = ::lseek(errors.get(), 0, SEEK_END);
        const off_t from = end > off_t(sizeof text - 1) ? end - off_t(sizeof text - 1) : 0;
        const ssize_t n = ::pread(errors.get(), text, sizeof text - 1, from);
        std::string words(text, n > 0 ? std::size_t(n) : 0);
        while (!words.empty() && words.back() == '\n') words.pop_back();
        return words.empty() ? "it said nothing" : "it said: " + words;
    }

    void end_and_check() {
        input.reset();
        const int status = wait();
        if (status != 0) fail("'" + def.program + "' failed with status " + std::to_string(status) + "; " + last_words());
    }
};

VideoWriter::VideoWriter(const VideoDef& def) {
    require_legal(def);
    process_ = std::make_unique<Process>(def);
}
VideoWriter::~VideoWriter() = default;
VideoWriter::VideoWriter(VideoWriter&&) noexcept = default;
VideoWriter& VideoWriter::operator=(VideoWriter&&) noexcept = default;

void VideoWriter::write(const Image& frame) {
    if (!process_ || process_->pid < 0) throw Error(ErrorCode::invalid_argument, "VideoWriter.write", "the video is finished already");
    const VideoDef& def = process_->def;
    if (frame.width != def.width || frame.height != def.height || frame.rgb.size() != std::size_t(def.width) * std::size_t(def.height) * 3)
        throw Error(ErrorCode::invalid_argument, "VideoWriter.write",
                    "a frame of " + std::to_string(frame.width) + " x " + std::to_string(frame.height) + " pixels in a video of " +
                        std::to_string(def.width) + " x " + std::to_string(def.height));
    const std::uint8_t* data = frame.rgb.data();
    for (std::size_t left = frame.rgb.size(); left > 0;) {
        const ssize_t n = ::send(process_->input.get(), data, left, MSG_NOSIGNAL);
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) {  // ffmpeg has gone: its own words explain it better than EPIPE
            const std::string reason = std::strerror(errno);
            process_->end_and_check();
            process_->fail("'" + def.program + "' stopped reading (" + reason + ")");
        }
        data += n;
        left -= std::size_t(n);
    }
}

void VideoWriter::finish() {
    if (process_ && process_->pid > 0) process_->end_and_check();
}

}  // namespace supple
