/* What the emulator calls: the input waits in an array, the answer is left in two variables. */
#include "uwb_predict.h"

float uwb_count_input[UWB_PREDICT_SAMPLES];
float uwb_count_output;
int uwb_count_status;

void uwb_count_call(void);
void uwb_count_stop(void);

void uwb_count_call(void) { uwb_count_status = uwb_predict(uwb_count_input, &uwb_count_output); }

void uwb_count_stop(void) {
  for (;;) {
  }
}
