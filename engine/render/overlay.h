#pragma once
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "supple/render/gl_objects.h"

namespace supple::render {

using Rgba = std::array<std::uint8_t, 4>;  ///< sRGB and opacity

/// Boxes and text on top of a picture, in pixels from its upper left corner. The font is DejaVu Sans, rasterised glyph by glyph as it is
/// needed, at the very size and quarter-pixel place where it stands.
/// (stb_truetype and not Dear ImGui: no window, input or global context is wanted for a caption, and the recorder needs no second library.)
class Overlay {
public:
    Overlay();
    ~Overlay();

    void begin(int width, int height);
    void box(float x, float y, float w, float h, float corner_radius, Rgba color);
    void gradient(float x, float y, float w, float h, Rgba above, Rgba below);
    /// @param baseline  y of the line the letters stand on
    /// @param size      height of a line from ascender to descender [px]
    void text(float x, float baseline, int size, Rgba color, std::string_view utf8);
    float text_width(int size, std::string_view utf8) const;
    float ascent(int size) const;
    /// Breaks at blanks, so that no line is wider than `width` (a longer word stands alone); keeps the line breaks of the text.
    std::vector<std::string> wrap(int size, float width, std::string_view utf8) const;
    void draw();  ///< into the framebuffer that is bound; sRGB values are written as they are

private:
    struct Vertex {
        float x, y, u, v;
        Rgba color;
        float local_x, local_y, radius, half_w, half_h;
    };
    struct Glyph {
        int x, y, w, h;            // in the atlas
        float offset_x, offset_y;  // from the pen to its upper left corner
    };
    struct Font;
    const Glyph& glyph(int index, int size, int quarter);
    void quad(float x0, float y0, float x1, float y1, Vertex corner, float u0 = 0, float v0 = 0, float u1 = 0, float v1 = 0);

    std::unique_ptr<Font> font_;
    std::map<std::array<int, 3>, Glyph> glyphs_;
    std::vector<std::uint8_t> atlas_;
    int shelf_x_ = 1, shelf_y_ = 1, shelf_height_ = 0;
    bool atlas_changed_ = true, atlas_full_ = false;

    int width_ = 1, height_ = 1;
    std::vector<Vertex> vertices_;
    Program program_;
    VertexArray array_;
    Buffer buffer_;
    Texture texture_;
};

}  // namespace supple::render
