#pragma once
#include "view/tool.h"

namespace supple::demos::view {

// One per file tool_<name>.cpp.
std::unique_ptr<Tool> make_grab_tool();     ///< a patch of surface follows the cursor
std::unique_ptr<Tool> make_pinch_tool();    ///< two jaws close on the surface, then follow the cursor
std::unique_ptr<Tool> make_poke_tool();     ///< a ball is pushed into the surface; it never pulls
std::unique_ptr<Tool> make_scalpel_tool();  ///< a drag over the picture is a cut into the depth
std::unique_ptr<Tool> make_burr_tool();     ///< a ball takes away the elements that it reaches

}  // namespace supple::demos::view
