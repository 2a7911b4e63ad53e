#pragma once
#include <memory>

#include "supple/render/frame_view.h"
#include "supple/render/image.h"

namespace supple {

struct RendererDef {
    int width = 1280, height = 720;  ///< pixels, 16..16384
    int samples = 4;                 ///< per pixel: 0 (no smoothing; for tests) or 2..what the driver has (Mesa in software: 4)
    int shadow_map_size = 512;       ///< texels along one side, a power of two in 128..8192
    bool ambient_occlusion = true;
};

struct DrawReport {
    std::size_t triangles = 0;
    double prepare_ms = 0;  ///< normals, occlusion, upload
    double draw_ms = 0;     ///< issuing the passes; a software driver does part of its work here, a graphics card none
};

/// Draws FrameViews with OpenGL 3.3 core into a framebuffer of its own, sRGB. The picture depends on the view alone, except for what
/// SurfaceView::reference_positions says about creases.
/// Needs a current context at construction, at every call, and at destruction: HeadlessContext, or that of a window. Leaves no
/// framebuffer, program or vertex array bound; other state is set at each draw and not put back.
class Renderer {
public:
    /// @error Error(invalid_argument) for values out of range, Error(no_display) without a current context of OpenGL 3.3,
    ///        Error(unsupported) if the driver refuses a shader or a framebuffer
    explicit Renderer(const RendererDef& def = {});
    ~Renderer();
    Renderer(Renderer&&) noexcept;
    Renderer& operator=(Renderer&&) noexcept;

    /// @error Error(invalid_argument) names the field of the view
    DrawReport draw(const FrameView& view);

    /// The last picture. Waits for it.
    Image read_pixels() const;
    void read_pixels(Image& into) const;  ///< the same without a new allocation

    /// Copies the last picture to another framebuffer of this context, e.g. 0 of a window, scaled to `width` x `height` pixels whose lower left one is
    /// (x, y).
    void blit_to(unsigned framebuffer, int width, int height, int x = 0, int y = 0) const;

    void resize(int width, int height);  ///< @error as the constructor
    int width() const;
    int height() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace supple
