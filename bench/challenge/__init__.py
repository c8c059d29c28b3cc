"""The proof of the diagnosis: concealed cases, and real recordings with the answer hidden."""
