#include "pd/bullet/contact_recorder.hpp"

#include "record/recorded_world.hpp"

namespace pd {

ContactRecorder::ContactRecorder(btCollisionWorld& world, const char* path, const ContactRecorderSettings& settings)
    : world_(new detail::RecordedWorld(world, path, settings.every)) {}

ContactRecorder::~ContactRecorder() { delete world_; }

bool ContactRecorder::close() { return world_->close(); }
bool ContactRecorder::good() const { return world_->good(); }
std::int64_t ContactRecorder::contacts() const { return world_->contacts(); }
std::int64_t ContactRecorder::unsupported() const { return world_->unsupported(); }

}  // namespace pd
