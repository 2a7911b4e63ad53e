#include "supple/render/overlay.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>

#include "supple/base/error.h"

#define STBTT_STATIC
#define STB_TRUETYPE_IMPLEMENTATION
#include <stb/stb_truetype.h>

namespace supple::render {
namespace {

constexpr int kAtlas = 1024;

/// Next code point of UTF-8 text; a broken byte is taken as U+FFFD.
std::uint32_t next_code_point(std::string_view text, std::size_t& at) {
    const auto byte = [&](std::size_t i) { return i < text.size() ? std::uint32_t(static_cast<unsigned char>(text[i])) : 0u; };
    const std::uint32_t lead = byte(at++);
    const int more = lead < 0x80 ? 0 : lead >> 5 == 6 ? 1 : lead >> 4 == 14 ? 2 : lead >> 3 == 30 ? 3 : -1;
    if (more <= 0) return more == 0 ? lead : 0xFFFD;
    std::uint32_t code = lead & (0x3Fu >> more);
    for (int k = 0; k < more; ++k) {
        if (byte(at) >> 6 != 2) return 0xFFFD;
        code = code << 6 | (byte(at++) & 0x3F);
    }
    return code;
}

}  // namespace

struct Overlay::Font {
    stbtt_fontinfo info{};
    Font() {
        const auto bytes = embedded_font("DejaVuSans.ttf");
        if (bytes.empty() || !stbtt_InitFont(&info, bytes.data(), 0))
            throw Error(ErrorCode::unsupported, "DejaVuSans.ttf",
                        "the embedded font cannot be read; configure the build with another SUPPLE_FONT of that name");
    }
    float scale(int size) const { return stbtt_ScaleForPixelHeight(&info, float(size)); }
    float advance(int glyph, int next) const {
        int width = 0, bearing = 0;
        stbtt_GetGlyphHMetrics(&info, glyph, &width, &bearing);
        return float(width + (next ? stbtt_GetGlyphKernAdvance(&info, glyph, next) : 0));
    }
    std::vector<int> glyphs(std::string_view utf8) const {
        std::vector<int> out;
        for (std::size_t at = 0; at < utf8.size();) out.push_back(stbtt_FindGlyphIndex(&info, int(next_code_point(utf8, at))));
        return out;
    }
};

Overlay::Overlay() : font_(std::make_unique<Font>()), atlas_(std::size_t(kAtlas) * kAtlas, 0), program_("overlay.vert", "overlay.frag") {
    glBindTexture(GL_TEXTURE_2D, texture_.get());
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_R8, kAtlas, kAtlas, 0, GL_RED, GL_UNSIGNED_BYTE, atlas_.data());
    // Glyphs are made at their final place and size: any filter would only smear them.
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, 0);

    glBindVertexArray(array_.get());
    glBindBuffer(GL_ARRAY_BUFFER, buffer_.get());
    const auto attribute = [](GLuint index, GLint size, GLenum type, GLboolean normalised, std::size_t offset) {
        glEnableVertexAttribArray(index);
        glVertexAttribPointer(index, size, type, normalised, sizeof(Vertex), reinterpret_cast<const void*>(offset));
    };
    attribute(0, 2, GL_FLOAT, GL_FALSE, offsetof(Vertex, x));
    attribute(1, 2, GL_FLOAT, GL_FALSE, offsetof(Vertex, u));
    attribute(2, 4, GL_UNSIGNED_BYTE, GL_TRUE, offsetof(Vertex, color));
    attribute(3, 3, GL_FLOAT, GL_FALSE, offsetof(Vertex, local_x));
    attribute(4, 2, GL_FLOAT, GL_FALSE, offsetof(Vertex, half_w));
    glBindVertexArray(0);
}

Overlay::~Overlay() = default;

void Overlay::begin(int width, int height) {
    width_ = width;
    height_ = height;
    vertices_.clear();
    if (atlas_full_) {  // too many sizes and alphabets so far: start again with those of this frame
        glyphs_.clear();
        std::fill(atlas_.begin(), atlas_.end(), std::uint8_t(0));
        shelf_x_ = shelf_y_ = 1;
        shelf_height_ = 0;
        atlas_full_ = false;
        atlas_changed_ = true;
    }
}

void Overlay::quad(float x0, float y0, float x1, float y1, Vertex corner, float u0, float v0, float u1, float v1) {
    const float mx = 0.5f * (x0 + x1), my = 0.5f * (y0 + y1);
    const auto put = [&](float x, float y, float u, float v) {
        Vertex vertex = corner;
        vertex.x = x;
        vertex.y = y;
        vertex.u = u / kAtlas;
        vertex.v = v / kAtlas;
        vertex.local_x = x - mx;
        vertex.local_y = y - my;
        vertices_.push_back(vertex);
    };
    put(x0, y0, u0, v0);
    put(x0, y1, u0, v1);
    put(x1, y0, u1, v0);
    put(x1, y0, u1, v0);
    put(x0, y1, u0, v1);
    put(x1, y1, u1, v1);
}

void Overlay::box(float x, float y, float w, float h, float corner_radius, Rgba color) {
    Vertex v{};
    v.color = color;
    v.half_w = 0.5f * w;
    v.half_h = 0.5f * h;
    v.radius = std::clamp(corner_radius, 0.0f, std::min(v.half_w, v.half_h));
    quad(x - 1, y - 1, x + w + 1, y + h + 1, v);  // a pixel more for the soft edge
}

void Overlay::gradient(float x, float y, float w, float h, Rgba above, Rgba below) {
    Vertex v{};
    v.half_w = v.half_h = 1e6f;
    quad(x, y, x + w, y + h, v);
    const std::size_t first = vertices_.size() - 6;
    for (std::size_t k = 0; k < 6; ++k) vertices_[first + k].color = k == 1 || k == 4 || k == 5 ? below : above;
}

const Overlay::Glyph& Overlay::glyph(int index, int size, int quarter) {
    const std::array<int, 3> key{index, size, quarter};
    if (const auto found = glyphs_.find(key); found != glyphs_.end()) return found->second;
    const float scale = font_->scale(size), shift = 0.25f * float(quarter);
    int x0, y0, x1, y1;
    stbtt_GetGlyphBitmapBoxSubpixel(&font_->info, index, scale, scale, shift, 0, &x0, &y0, &x1, &y1);
    Glyph g{0, 0, x1 - x0, y1 - y0, float(x0), float(y0)};
    if (g.w > 0 && g.h > 0) {
        if (shelf_x_ + g.w + 1 > kAtlas) {
            shelf_x_ = 1;
            shelf_y_ += shelf_height_ + 1;
            shelf_height_ = 0;
        }
        if (g.w + 2 > kAtlas || shelf_y_ + g.h + 1 > kAtlas) {
            atlas_full_ = true;  // left out of this frame, there in the next
            g.w = g.h = 0;
        } else {
            g.x = shelf_x_;
            g.y = shelf_y_;
            stbtt_MakeGlyphBitmapSubpixel(&font_->info, &atlas_[std::size_t(g.y * kAtlas + g.x)], g.w, g.h, kAtlas, scale, scale, shift, 0,
                                          index);
            shelf_x_ += g.w + 1;
            shelf_height_ = std::max(shelf_height_, g.h);
            atlas_changed_ = true;
        }
    }
    return glyphs_.emplace(key, g).first->second;
}

void Overlay::text(float x, float baseline, int size, Rgba color, std::string_view utf8) {
    const std::vector<int> glyphs = font_->glyphs(utf8);
    const float scale = font_->scale(size);
    baseline = std::round(baseline);
    for (std::size_t i = 0; i < glyphs.size(); ++i) {
        const float whole = std::floor(x);
        const Glyph g = glyph(glyphs[i], size, int(4 * (x - whole)));
        if (g.w > 0) {
            Vertex v{};
            v.color = color;
            v.radius = -1;
            const float left = whole + g.offset_x, top = baseline + g.offset_y;
            quad(left, top, left + float(g.w), top + float(g.h), v, float(g.x), float(g.y), float(g.x + g.w), float(g.y + g.h));
        }
        x += scale * font_->advance(glyphs[i], i + 1 < glyphs.size() ? glyphs[i + 1] : 0);
    }
}

float Overlay::text_width(int size, std::string_view utf8) const {
    const std::vector<int> glyphs = font_->glyphs(utf8);
    float width = 0;
    for (std::size_t i = 0; i < glyphs.size(); ++i) width += font_->advance(glyphs[i], i + 1 < glyphs.size() ? glyphs[i + 1] : 0);
    return width * font_->scale(size);
}

float Overlay::ascent(int size) const {
    int ascent = 0, descent = 0, gap = 0;
    stbtt_GetFontVMetrics(&font_->info, &ascent, &descent, &gap);
    return float(ascent) * font_->scale(size);
}

std::vector<std::string> Overlay::wrap(int size, float width, std::string_view utf8) const {
    std::vector<std::string> lines(1);
    std::string word;
    const auto end_word = [&] {
        if (word.empty()) return;
        const std::string longer = lines.back().empty() ? word : lines.back() + ' ' + word;
        if (lines.back().empty() || text_width(size, longer) <= width)
            lines.back() = longer;
        else
            lines.push_back(word);
        word.clear();
    };
    for (const char c : utf8) {
        if (c != ' ' && c != '\n') {
            word += c;
            continue;
        }
        end_word();
        if (c == '\n') lines.emplace_back();
    }
    end_word();
    return lines;
}

void Overlay::draw() {
    if (vertices_.empty()) return;
    glActiveTexture(GL_TEXTURE0);
    glBindTexture(GL_TEXTURE_2D, texture_.get());
    if (atlas_changed_) {
        glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
        glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, kAtlas, kAtlas, GL_RED, GL_UNSIGNED_BYTE, atlas_.data());
        atlas_changed_ = false;
    }
    program_.use();
    program_.set("font", 0);
    program_.set("picture_size", Eigen::Vector2f(float(width_), float(height_)));
    glBindVertexArray(array_.get());
    upload_buffer(GL_ARRAY_BUFFER, buffer_, std::span<const Vertex>(vertices_), GL_STREAM_DRAW);
    glEnable(GL_BLEND);
    glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
    glDrawArrays(GL_TRIANGLES, 0, GLsizei(vertices_.size()));
    glDisable(GL_BLEND);
}

}  // namespace supple::render
