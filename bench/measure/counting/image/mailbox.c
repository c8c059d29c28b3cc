/* What the emulator calls: the input waits in an array, the answer is left in two variables. */
#include "uwb_predict.h"

#ifdef UWB_PREDICT_ROW_VALUES /* models that read more than the CIR: all inputs in one row */
#define VALUES UWB_PREDICT_ROW_VALUES
#define PREDICT uwb_predict_row
#else
#define VALUES UWB_PREDICT_SAMPLES
#define PREDICT uwb_predict
#endif

float uwb_count_input[VALUES];
float uwb_count_output;
int uwb_count_status;

void uwb_count_call(void);
void uwb_count_stop(void);

void uwb_count_call(void) { uwb_count_status = PREDICT(uwb_count_input, &uwb_count_output); }

void uwb_count_stop(void) {
  for (;;) {
  }
}
