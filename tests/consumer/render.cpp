#include <supple/base/error.h>
#include <supple/render/context.h>
#include <supple/render/renderer.h>

// Drawing needs a driver; a client without one must still link and be told.
int main() {
    try {
        supple::HeadlessContext context;
        supple::Renderer renderer({.width = 64, .height = 64, .samples = 0});
        renderer.draw({});
        return renderer.read_pixels().width == 64 ? 0 : 1;
    } catch (const supple::Error& error) {
        return error.code() == supple::ErrorCode::no_display ? 0 : 1;
    }
}
