// A stub for a test, of our own: the names of ArduPilot's parameters that the glue uses.
#pragma once

#include <stdint.h>

template <class T> class Parameter {
public:
    operator const T &() const { return value; }
    explicit operator double() const { return value; }
    T get() const { return value; }
    void set(T to) { value = to; }

private:
    T value;
};
typedef Parameter<int8_t> AP_Int8;
typedef Parameter<int16_t> AP_Int16;
typedef Parameter<float> AP_Float;

namespace AP_Param {
struct GroupInfo {
    const char *name;
    void (*set)(void *, float);
    float value;
};
inline void setup_object_defaults(void *object, const GroupInfo *info) {
    for (; info->name; ++info) info->set(object, info->value);
}
}
#define AP_PARAM_FLAG_ENABLE 1
#define AP_GROUPINFO(name, index, of, element, value) \
    {name, [](void *object, float to) { static_cast<of *>(object)->element.set(to); }, value}
#define AP_GROUPINFO_FLAGS(name, index, of, element, value, flags) AP_GROUPINFO(name, index, of, element, value)
#define AP_GROUPEND {nullptr, nullptr, 0}
