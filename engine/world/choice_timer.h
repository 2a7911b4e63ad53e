#pragma once

namespace supple {

/// PreconditionerKind::automatic_timed: how long solves take with each of two preconditioners, and when the one that rests has a try. Of this run alone: no state, and no snapshot holds it.
///
/// The one that rests is tried every so often, and has four fifths of the time that the other takes. Where it is done by then in three solves one after the other, it is at work from there on.
class ChoiceTimer {
public:
    static constexpr int kFirstTrial = 20, kTrialEvery = 200;  ///< solves
    static constexpr int kWins = 3;
    static constexpr double kGain = 0.8;

    bool trial_is_due() const { return waited_ >= wait_; }
    /// What a trial may take [ms].
    double trial_ms() const { return kGain * mean_ms_; }

    /// A solve with what is at work took so long.
    void note(double ms) {
        mean_ms_ = mean_ms_ == 0 ? ms : 0.9 * mean_ms_ + 0.1 * ms;
        ++waited_;
    }
    /// A trial was done in time. True if the other is at work from now on.
    bool won() {
        if (++wins_ < kWins) return false;
        *this = ChoiceTimer(kTrialEvery);
        return true;
    }
    void lost() {
        wins_ = waited_ = 0;
        wait_ = kTrialEvery;
    }

    ChoiceTimer() = default;

private:
    explicit ChoiceTimer(int wait) : wait_(wait) {}

    double mean_ms_ = 0;
    int waited_ = 0, wait_ = kFirstTrial, wins_ = 0;
};

}  // namespace supple
