#pragma once
#include <memory>
#include <string>

#include "supple/render/image.h"

namespace supple {

struct VideoDef {
    std::string path;                ///< the ending chooses the container, e.g. out/liver.mp4; replaced if it exists
    int width = 1280, height = 720;  ///< even, 2..16384
    double frames_per_s = 60;        ///< 1..1000
    int quality = 18;                ///< x264 constant rate factor, 0 (lossless, huge) .. 51 (ugly, small)
    std::string program = "ffmpeg";  ///< searched in PATH
};

/// Pipes raw frames to ffmpeg (H.264, yuv420p, playable from its first byte).
/// No shell is involved and no signal reaches the host: a dying ffmpeg is an Error with its last words.
class VideoWriter {
public:
    /// @error Error(external_tool) if the program is absent; Error(invalid_argument) for odd sizes and other values out of range
    explicit VideoWriter(const VideoDef& def);
    ~VideoWriter();  ///< an unfinished video is closed as well as it can be; never throws. Call finish() to hear of failures.
    VideoWriter(VideoWriter&&) noexcept;
    VideoWriter& operator=(VideoWriter&&) noexcept;

    /// Appends one frame. @error Error(invalid_argument) for another size, Error(external_tool) if ffmpeg stopped
    void write(const Image& frame);

    /// Closes the pipe, waits for ffmpeg and checks its status; calling it again does nothing. @error Error(external_tool)
    void finish();

private:
    struct Process;
    std::unique_ptr<Process> process_;
};

}  // namespace supple
