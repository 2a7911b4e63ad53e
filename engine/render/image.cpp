#include "supple/render/image.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <memory>

#include "supple/base/error.h"

// Static copies: a host that links stb itself must not meet our symbols.
#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_WRITE_IMPLEMENTATION
#include <stb/stb_image_write.h>
#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#define STBI_ONLY_PNG
#define STBI_NO_STDIO
#include <stb/stb_image.h>

namespace supple {
namespace {

struct FileCloser {
    void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, FileCloser>;

void require_consistent(const Image& image, const char* where) {
    if (image.width < 1 || image.height < 1 || image.rgb.size() != std::size_t(image.width) * std::size_t(image.height) * 3)
        throw Error(ErrorCode::invalid_argument, where,
                    "an image of " + std::to_string(image.width) + " x " + std::to_string(image.height) + " pixels holds " +
                        std::to_string(image.rgb.size()) + " bytes; it needs width x height x 3, sizes from 1");
}

void append(void* context, void* data, int size) {
    auto& bytes = *static_cast<std::vector<unsigned char>*>(context);
    const auto* begin = static_cast<const unsigned char*>(data);
    bytes.insert(bytes.end(), begin, begin + size);
}

}  // namespace

void write_png(const std::string& path, const Image& image) {
    require_consistent(image, "write_png");
    std::vector<unsigned char> bytes;
    bytes.reserve(image.rgb.size() / 2);
    if (!stbi_write_png_to_func(append, &bytes, image.width, image.height, 3, image.rgb.data(), image.width * 3))
        throw Error(ErrorCode::file_unreadable, path, "the picture could not be packed: out of memory");
    File file(std::fopen(path.c_str(), "wb"));
    if (!file) throw Error(ErrorCode::file_unreadable, path, "cannot be written; does its folder exist, and may you write there?");
    const bool written = std::fwrite(bytes.data(), 1, bytes.size(), file.get()) == bytes.size();
    if (std::fclose(file.release()) != 0 || !written)
        throw Error(ErrorCode::file_unreadable, path, "was written only in part; is the disk full?");
}

Image read_png(const std::string& path) {
    File file(std::fopen(path.c_str(), "rb"));
    if (!file) throw Error(ErrorCode::file_unreadable, path, "cannot be opened for reading");
    std::vector<unsigned char> bytes;
    unsigned char chunk[1 << 16];
    for (std::size_t n; (n = std::fread(chunk, 1, sizeof chunk, file.get())) > 0;) bytes.insert(bytes.end(), chunk, chunk + n);
    int width = 0, height = 0, channels = 0;
    const std::unique_ptr<unsigned char, void (*)(void*)> pixels(
        stbi_load_from_memory(bytes.data(), int(bytes.size()), &width, &height, &channels, 3), &std::free);
    if (!pixels) throw Error(ErrorCode::parse, path, std::string("is not a PNG that can be read: ") + stbi_failure_reason());
    const std::size_t size = std::size_t(width) * std::size_t(height) * 3;
    return {width, height, std::vector<std::uint8_t>(pixels.get(), pixels.get() + size)};
}

ImageDifference compare(const Image& a, const Image& b) {
    require_consistent(a, "compare");
    require_consistent(b, "compare");
    if (a.width != b.width || a.height != b.height)
        throw Error(ErrorCode::invalid_argument, "compare",
                    "images of " + std::to_string(a.width) + " x " + std::to_string(a.height) + " and " + std::to_string(b.width) + " x " +
                        std::to_string(b.height) + " pixels cannot be compared; give them one size");
    ImageDifference d;
    std::size_t above = 0;
    for (std::size_t p = 0; p < a.rgb.size(); p += 3) {
        int worst = 0;
        for (std::size_t c = p; c < p + 3; ++c) {
            const int e = std::abs(int(a.rgb[c]) - int(b.rgb[c]));
            d.mean += e;
            worst = std::max(worst, e);
        }
        d.max = std::max(d.max, worst);
        above += worst > 16;
    }
    d.mean /= double(a.rgb.size());
    d.fraction_above_16 = double(above) / (double(a.rgb.size()) / 3);
    return d;
}

}  // namespace supple
