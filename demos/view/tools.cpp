#include "view/tools.h"

namespace supple::demos::view {

std::vector<std::unique_ptr<Tool>> make_tools() {
    std::vector<std::unique_ptr<Tool>> tools;
    tools.push_back(make_grab_tool());
    tools.push_back(make_pinch_tool());
    tools.push_back(make_poke_tool());
    tools.push_back(make_scalpel_tool());
    tools.push_back(make_burr_tool());
    return tools;
}

}  // namespace supple::demos::view
