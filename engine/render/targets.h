#pragma once
#include "supple/render/gl_objects.h"

namespace supple::render {

/// The framebuffers of a renderer: one with several samples a pixel that the scene is drawn to, one with a single sample for the result.
class Targets {
public:
    /// @param samples  0 for none: then the scene is drawn to the result itself. @error Error(unsupported)
    Targets(int width, int height, int samples);
    void bind_scene() const;
    void resolve() const;  ///< scene to result, which is bound afterwards
    GLuint result() const { return result_.get(); }

private:
    int width_, height_, samples_;
    Framebuffer scene_, result_;
    Renderbuffer scene_color_, scene_depth_, result_depth_;
    Texture result_color_;
};

/// The shadow map of the key light, and the soft shadow on the ground that is made from it.
class ShadowTargets {
public:
    explicit ShadowTargets(int size);
    void bind_map() const;     ///< cleared
    void bind_ground() const;
    void finish_ground() const;  ///< builds its mip levels
    int size() const { return size_; }
    int ground_size() const { return size_ / 2; }

    /// To be sampled with comparison (filtered), or as plain depths.
    void use_map_compared(int unit) const;
    void use_map_depth(int unit) const;
    void use_ground(int unit) const;

private:
    int size_;
    Framebuffer map_, ground_;
    Texture map_depth_, ground_shadow_;
    Sampler compared_, plain_;
};

}  // namespace supple::render
