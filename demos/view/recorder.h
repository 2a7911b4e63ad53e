#pragma once
#include <optional>
#include <string>

#include "supple/render/video.h"

namespace supple::demos::view {

/// The first of base_001.ending, base_002.ending, ... that is not there yet.
std::string free_name(const std::string& base, const std::string& ending);

/// Films the picture of the scene at a constant rate, whatever the rate of the window: pictures are repeated or left out.
class Recorder {
public:
    static constexpr double kFramesPerS = 60;

    bool records() const { return video_.has_value(); }
    const std::string& file() const { return file_; }
    double length_s() const { return double(written_) / kFramesPerS; }

    /// @error Error(external_tool) without ffmpeg
    void begin(const std::string& base, int width, int height);
    /// @param image      of any size; where it is not that of the film, false: the film ends here
    /// @param elapsed_s  real time since the last picture
    bool add(const Image& image, double elapsed_s);
    void end();  ///< @error Error(external_tool) where ffmpeg failed

private:
    std::optional<VideoWriter> video_;
    std::string file_;
    int width_ = 0, height_ = 0;
    Image even_;
    double clock_s_ = 0;
    std::size_t written_ = 0;
};

}  // namespace supple::demos::view
