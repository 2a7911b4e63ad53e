#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace supple {

/// An sRGB picture, 8 bits a channel, rows from the top, no padding.
struct Image {
    int width = 0, height = 0;      ///< pixels
    std::vector<std::uint8_t> rgb;  ///< width x height x 3
};

struct ImageDifference {
    double mean = 0;  ///< of |a - b| over all channels, 0..255
    int max = 0;
    double fraction_above_16 = 0;  ///< share of the pixels where any channel differs by more than 16
};

/// @error Error(file_unreadable) if the file cannot be written, Error(invalid_argument) if sizes and data disagree
void write_png(const std::string& path, const Image& image);

/// Reads any PNG as 8-bit RGB; alpha is dropped.
/// @error Error(file_unreadable / parse)
Image read_png(const std::string& path);

/// @error Error(invalid_argument) if the sizes differ
ImageDifference compare(const Image& a, const Image& b);

}  // namespace supple
