#pragma once
#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "view/gui.h"
#include "view/viewport.h"
#include "view/window.h"

namespace supple::demos::view {

/// A hand that follows a text: mouse, keys and controls as a person would use them, frame by frame, so that a run can be repeated to the bit.
///
/// One command a line, `#` begins a comment; each takes at least one frame.
///   wait N                  N frames pass
///   move X Y [N]            the cursor goes there in N frames; parts of the scene's picture, 0 0 is its upper left corner
///   press BUTTON            left, right or middle goes down, and stays so
///   release BUTTON
///   scroll N                the wheel
///   key NAME                space, period, minus, plus, tab, escape, f1, a letter or a digit; shift+p
///   click CONTROL           on a control of a panel by its name; `law/NeoHookean` is an entry of an open list
///   slide CONTROL PART      a slider's handle goes to a part 0..1 of its length
///   picture FILE            the window as it looks in this frame, as PNG
///   resize W H              the window
///   drop FILE               on the window
///   print                   the state as one line of JSON
class Script {
public:
    Script() = default;
    /// @error Error(file_unreadable), Error(parse) "file:line: ..."
    explicit Script(const std::filesystem::path& file);

    bool plays() const { return !file_.empty(); }
    bool ended() const { return next_ == commands_.size() && queue_at_ == queue_.size() && reaching_ == nullptr; }

    /// What the cursor does in this frame; call it between the backend's new frame and ImGui's.
    /// @error Error(invalid_argument) "file:line: ..." for a control that is not there or not in sight
    void play(const Viewport& viewport, Window& window);

    /// What the viewer has to do at the end of this frame.
    const std::string& picture() const { return picture_; }
    bool prints() const { return prints_; }

private:
    struct Command {
        int line = 0;
        std::vector<std::string> words;
    };
    /// The mouse in one frame.
    struct Moment {
        ImVec2 cursor;
        std::array<bool, 3> down{};
        float wheel = 0;
    };

    [[noreturn]] void fail(const Command& command, const std::string& message) const;
    double number(const Command& command, std::size_t word) const;
    void begin(const Command& command, const Viewport& viewport, Window& window);
    void act(const Command& command, const Viewport& viewport, Window& window);
    void use_control(const Command& command);
    void stay(int frames);

    std::string file_;
    std::vector<Command> commands_;
    std::size_t next_ = 0;
    std::vector<Moment> queue_;  ///< of the command at work
    std::size_t queue_at_ = 0;
    Moment now_{ImVec2(-1, -1), {}, 0};
    const Command* reaching_ = nullptr;  ///< for a control that is being scrolled into sight
    int reached_for_ = 0;
    std::string picture_;
    bool prints_ = false;
};

}  // namespace supple::demos::view
