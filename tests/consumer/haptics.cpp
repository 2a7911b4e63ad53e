#include <supple/haptics/plain_devices.h>
#include <supple/haptics/servo.h>

int main() {
    supple::haptics::PlayedDevice device(supple::haptics::device_preset("touch"), {.times_s = {0}, .positions_m = {supple::Vec3::Zero()}});
    supple::haptics::HapticLoop loop(device, {});
    const supple::haptics::Servo servo(loop, device, {.priority = 0});
    return servo.real_time() ? 1 : 0;
}
