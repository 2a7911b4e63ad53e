#include "view/recorder.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>

namespace supple::demos::view {

std::string free_name(const std::string& base, const std::string& ending) {
    for (int i = 1;; ++i) {
        char number[16];
        std::snprintf(number, sizeof number, "_%03d", i);
        std::string name = base + number + ending;
        if (!std::filesystem::exists(name)) return name;
    }
}

void Recorder::begin(const std::string& base, int width, int height) {
    end();
    width_ = width;
    height_ = height;
    even_.width = width & ~1;  // H.264 with half the colours wants even sizes
    even_.height = height & ~1;
    even_.rgb.resize(std::size_t(even_.width) * std::size_t(even_.height) * 3);
    file_ = free_name(base, ".mp4");
    clock_s_ = 0;
    written_ = 0;
    video_.emplace(VideoDef{.path = file_, .width = even_.width, .height = even_.height, .frames_per_s = kFramesPerS});
}

bool Recorder::add(const Image& image, double elapsed_s) {
    if (image.width != width_ || image.height != height_) return false;
    clock_s_ += elapsed_s;
    const std::size_t row = std::size_t(even_.width) * 3;
    for (std::size_t y = 0; y < std::size_t(even_.height); ++y)
        std::copy_n(image.rgb.begin() + std::ptrdiff_t(y * std::size_t(width_) * 3), row, even_.rgb.begin() + std::ptrdiff_t(y * row));
    constexpr double kHalfBillionth = 5e-10;
    for (; double(written_) < clock_s_ * kFramesPerS * (1 + kHalfBillionth); ++written_) video_->write(even_);
    return true;
}

void Recorder::end() {
    if (!video_) return;
    VideoWriter video = std::move(*video_);
    video_.reset();
    video.finish();
}

}  // namespace supple::demos::view
