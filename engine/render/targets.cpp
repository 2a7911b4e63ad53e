#include "supple/render/targets.h"

namespace supple::render {

Targets::Targets(int width, int height, int samples) : width_(width), height_(height), samples_(samples) {
    const auto make = [&](const Framebuffer& framebuffer, const Texture& texture, const char* what) {
        glBindTexture(GL_TEXTURE_2D, texture.get());
        glTexImage2D(GL_TEXTURE_2D, 0, GL_SRGB8_ALPHA8, width, height, 0, GL_RGBA, GL_UNSIGNED_BYTE, nullptr);
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, 0);
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
        glBindFramebuffer(GL_FRAMEBUFFER, framebuffer.get());
        glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, texture.get(), 0);
        require_complete(GL_FRAMEBUFFER, what);
    };
    make(result_, result_color_, "Renderer: picture");
    make(resolved_, resolved_color_, "Renderer: scene");
    glBindRenderbuffer(GL_RENDERBUFFER, scene_depth_.get());
    glRenderbufferStorageMultisample(GL_RENDERBUFFER, samples, GL_DEPTH_COMPONENT24, width, height);  // no samples: a plain one
    if (samples > 0) {
        glBindFramebuffer(GL_FRAMEBUFFER, scene_.get());
        glBindRenderbuffer(GL_RENDERBUFFER, scene_color_.get());
        glRenderbufferStorageMultisample(GL_RENDERBUFFER, samples, GL_SRGB8_ALPHA8, width, height);
        glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, scene_color_.get());
    }
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, scene_depth_.get());
    require_complete(GL_FRAMEBUFFER, "Renderer: samples");
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
}

void Targets::bind_scene() const {
    glBindFramebuffer(GL_FRAMEBUFFER, samples_ > 0 ? scene_.get() : resolved_.get());
    glViewport(0, 0, width_, height_);
}

void Targets::bind_result() const {
    glBindFramebuffer(GL_FRAMEBUFFER, result_.get());
    glViewport(0, 0, width_, height_);
}

void Targets::resolve_scene(int x, int y, int width, int height) const {
    if (samples_ == 0) return;
    glBindFramebuffer(GL_READ_FRAMEBUFFER, scene_.get());
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, resolved_.get());
    glBlitFramebuffer(x, y, x + width, y + height, x, y, x + width, y + height, GL_COLOR_BUFFER_BIT, GL_NEAREST);
}

void Targets::use_scene(int unit) const {
    glActiveTexture(GL_TEXTURE0 + GLenum(unit));
    glBindTexture(GL_TEXTURE_2D, resolved_color_.get());
}

ShadowTargets::ShadowTargets(int size) : size_(size) {
    glBindTexture(GL_TEXTURE_2D, map_depth_.get());
    glTexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT24, size, size, 0, GL_DEPTH_COMPONENT, GL_UNSIGNED_INT, nullptr);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, 0);
    glBindFramebuffer(GL_FRAMEBUFFER, map_.get());
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, map_depth_.get(), 0);
    glDrawBuffer(GL_NONE);
    glReadBuffer(GL_NONE);
    require_complete(GL_FRAMEBUFFER, "Renderer: shadow map");

    // Outside the map everything is lit: a border at the far end of the depths.
    const float far_away[] = {1, 1, 1, 1};
    for (const Sampler* sampler : {&compared_, &plain_}) {
        const bool compare = sampler == &compared_;
        glSamplerParameteri(sampler->get(), GL_TEXTURE_MIN_FILTER, compare ? GL_LINEAR : GL_NEAREST);
        glSamplerParameteri(sampler->get(), GL_TEXTURE_MAG_FILTER, compare ? GL_LINEAR : GL_NEAREST);
        glSamplerParameteri(sampler->get(), GL_TEXTURE_WRAP_S, GL_CLAMP_TO_BORDER);
        glSamplerParameteri(sampler->get(), GL_TEXTURE_WRAP_T, GL_CLAMP_TO_BORDER);
        glSamplerParameterfv(sampler->get(), GL_TEXTURE_BORDER_COLOR, far_away);
        glSamplerParameteri(sampler->get(), GL_TEXTURE_COMPARE_MODE, compare ? GL_COMPARE_REF_TO_TEXTURE : GL_NONE);
    }

    const auto make = [&](const Framebuffer& framebuffer, const Texture& texture, GLint format, GLenum channels, const char* what) {
        glBindTexture(GL_TEXTURE_2D, texture.get());
        glTexImage2D(GL_TEXTURE_2D, 0, format, ground_size(), ground_size(), 0, channels, GL_FLOAT, nullptr);
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, format == GL_R8 ? GL_LINEAR : GL_LINEAR_MIPMAP_LINEAR);
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
        glBindFramebuffer(GL_FRAMEBUFFER, framebuffer.get());
        glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, texture.get(), 0);
        require_complete(GL_FRAMEBUFFER, what);
    };
    make(mask_, ground_mask_, GL_RG16F, GL_RG, "Renderer: mask of the ground shadow");
    make(ground_, ground_shadow_, GL_R8, GL_RED, "Renderer: ground shadow");
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
}

void ShadowTargets::bind_map() const {
    glBindFramebuffer(GL_FRAMEBUFFER, map_.get());
    glViewport(0, 0, size_, size_);
    glClear(GL_DEPTH_BUFFER_BIT);
}

void ShadowTargets::bind_ground_mask() const {
    glBindFramebuffer(GL_FRAMEBUFFER, mask_.get());
    glViewport(0, 0, ground_size(), ground_size());
}

void ShadowTargets::bind_ground() const {
    glBindFramebuffer(GL_FRAMEBUFFER, ground_.get());
    glViewport(0, 0, ground_size(), ground_size());
}

void ShadowTargets::finish_ground_mask() const {
    glActiveTexture(GL_TEXTURE0);
    glBindTexture(GL_TEXTURE_2D, ground_mask_.get());
    glGenerateMipmap(GL_TEXTURE_2D);
}

void ShadowTargets::use_map_compared(int unit) const {
    glActiveTexture(GL_TEXTURE0 + GLenum(unit));
    glBindTexture(GL_TEXTURE_2D, map_depth_.get());
    glBindSampler(GLuint(unit), compared_.get());
}

void ShadowTargets::use_map_depth(int unit) const {
    glActiveTexture(GL_TEXTURE0 + GLenum(unit));
    glBindTexture(GL_TEXTURE_2D, map_depth_.get());
    glBindSampler(GLuint(unit), plain_.get());
}

void ShadowTargets::use_ground_mask(int unit) const {
    glActiveTexture(GL_TEXTURE0 + GLenum(unit));
    glBindTexture(GL_TEXTURE_2D, ground_mask_.get());
    glBindSampler(GLuint(unit), 0);
}

void ShadowTargets::use_ground(int unit) const {
    glActiveTexture(GL_TEXTURE0 + GLenum(unit));
    glBindTexture(GL_TEXTURE_2D, ground_shadow_.get());
    glBindSampler(GLuint(unit), 0);
}

}  // namespace supple::render
