#pragma once
#include "supple/render/frame_view.h"
#include "supple/render/overlay.h"

namespace supple::render {

/// Puts the legend, the HUD line and the caption of a frame into the overlay, sized to the picture (designed at 720 lines).
/// @param with_legend  whether any surface is coloured by view.scale
void annotate(Overlay& overlay, const FrameView& view, bool with_legend, int width, int height);

}  // namespace supple::render
