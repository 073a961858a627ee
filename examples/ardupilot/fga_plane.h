// fga inside ArduPlane: parameters and tasks. See docs/how-to-ardupilot-inside.md.
#pragma once

#include <AP_Param/AP_Param.h>

class FgaPlane {
public:
    FgaPlane() { AP_Param::setup_object_defaults(this, var_info); }
    void update();  // at 10 Hz
    void watch();   // at 50 Hz: the watchdog
    static const AP_Param::GroupInfo var_info[];

private:
    bool begin();
    static int mode();
    static void follow_mission();
    void hear_traffic(double now_s);
    static void give_back(uint16_t to);
    AP_Int8 _enable;
    AP_Float _radius, _bank, _factor, _lag, _sigma;
};
